//! Text files in other encodings than UTF-8. They are refused with a message that names the encoding and the remedy.

/// Why a file is not read as text.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct NotUtf8 {
    /// Line with the first byte that is not UTF-8, counted from 1; 1 for a file in UTF-16.
    pub line: usize,
    /// Description of the problem, for a message.
    pub problem: String,
    /// Advice what to do about the problem.
    pub hint: &'static str,
}

/// The text of the bytes of a file.
///
/// # Errors
/// The bytes are not in UTF-8.
pub(crate) fn decode(bytes: Vec<u8>) -> Result<String, NotUtf8> {
    // spreadsheets write "Unicode text" in UTF-16, with one of these two marks at its beginning
    if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
        return Err(NotUtf8 {
            line: 1,
            problem: "is in UTF-16, and not in UTF-8".into(),
            hint: "save the file in UTF-8 (spreadsheets: \"CSV UTF-8\"), or convert it by `iconv -f utf16 -t utf8`",
        });
    }
    String::from_utf8(bytes).map_err(|e| {
        let before = &e.as_bytes()[..e.utf8_error().valid_up_to()];
        let byte = e.as_bytes().get(before.len()).copied().unwrap_or_default();
        NotUtf8 {
            line: before.iter().filter(|byte| **byte == b'\n').count() + 1,
            problem: format!("is not in UTF-8: the byte {byte:#04x} begins no character"),
            hint: "save the file in UTF-8; a file in Latin-1 is converted by `iconv -f latin1 -t utf8`",
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_encodings_are_named_with_their_line() {
        assert_eq!(decode(b"a,b\n1,2\n".to_vec()).as_deref(), Ok("a,b\n1,2\n"));
        let latin = decode(b"a,b\n1,\xb5\n".to_vec()).expect_err("Latin-1");
        assert_eq!(latin.line, 2);
        assert!(latin.problem.contains("0xb5") && latin.hint.contains("latin1"), "{latin:?}");
        for mark in [[0xff, 0xfe], [0xfe, 0xff]] {
            let utf16 = decode(mark.into_iter().chain([b'a', 0]).collect()).expect_err("UTF-16");
            assert!(utf16.problem.contains("UTF-16") && utf16.hint.contains("utf16"), "{utf16:?}");
        }
    }
}
