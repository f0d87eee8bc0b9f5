//! Numbers as text: with a stated number of digits for people, in shortest round-trip form for files.

/// A value with `digits` significant digits. Trailing zeros are kept: `significant(1.4, 3)` is `1.40`.
///
/// Values from 1e-4 to 1e7 are written as plain decimals, others with an exponent. Integers with more than `digits`
/// digits are rounded, not cut: `significant(123456.0, 3)` is `123000`.
pub fn significant(value: f64, digits: usize) -> String {
    let digits = digits.max(1);
    if value == 0.0 || !value.is_finite() {
        return plain(value);
    }
    // the exponent is taken after rounding: 9.996 with three digits is 1.00e1
    let rounded = format!("{value:.*e}", digits - 1);
    let Some((mantissa, exponent)) = rounded.split_once('e') else { return rounded };
    let exponent: i32 = exponent.parse().unwrap_or(0);
    if !(-4..7).contains(&exponent) {
        return format!("{mantissa}e{exponent}");
    }
    let decimals = digits as i32 - 1 - exponent;
    match rounded.parse::<f64>() {
        Ok(v) => format!("{v:.*}", decimals.max(0) as usize),
        Err(_) => rounded,
    }
}

/// `mantissa · 10^power`. The division keeps negative powers exact to the last digit.
pub(crate) fn times_power_of_ten(mantissa: f64, power: i32) -> f64 {
    if power < 0 { mantissa / 10f64.powi(-power) } else { mantissa * 10f64.powi(power) }
}

/// A value with `decimals` digits after the point; never `-0.00`.
pub fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let is_negative_zero = text.starts_with('-') && !text.bytes().any(|b| (b'1'..=b'9').contains(&b));
    if is_negative_zero { text[1..].to_string() } else { text }
}

/// A value and the two ends of its interval as text, all with the same number of decimals. With this number, the
/// distance from the value to the nearer end has two significant digits. An end that is not known is `open`; without
/// any end the value has four digits.
pub(crate) fn with_ends(value: f64, ends: [Option<f64>; 2]) -> [String; 3] {
    let known = || ends.into_iter().flatten();
    let power = |x: f64| libm::log10(x.abs()).floor() as i32;
    let sides = known().map(|end| (end - value).abs()).filter(|side| *side > 0.0 && side.is_finite());
    let side = sides.fold(f64::INFINITY, f64::min);
    let largest = known().fold(value.abs(), |most, end| most.max(end.abs()));
    let (decimals, digits) = match side.is_finite() {
        true => (1 - power(side), (power(largest) - power(side) + 2).max(3)),
        false => (-1, 4),
    };
    let is_plain = (1e-4..1e7).contains(&largest) && decimals >= 0;
    let text = |x: f64| if is_plain { fixed(x, decimals as usize) } else { significant(x, digits as usize) };
    let end = |end: Option<f64>| end.map_or("open".into(), text);
    [text(value), end(ends[0]), end(ends[1])]
}

/// A percentage with `decimals` digits after the point: `12.5 %`.
pub fn percent(value: f64, decimals: usize) -> String {
    format!("{} %", fixed(value, decimals))
}

/// A percentage with `digits` significant digits: `2.0 %`.
pub fn percent_rounded(value: f64, digits: usize) -> String {
    format!("{} %", significant(value, digits))
}

/// A fraction in percent, with one decimal unless that decimal is zero.
pub fn percent_short(share: f64) -> String {
    let text = format!("{:.1}", 100.0 * share);
    format!("{} %", text.strip_suffix(".0").unwrap_or(&text))
}

/// The percentage that a part is of a whole. It is never rounded to 0 % or to 100 % unless it is exactly that.
pub fn percent_of(part: usize, whole: usize) -> String {
    let share = 100.0 * part as f64 / whole.max(1) as f64;
    match share {
        _ if part == 0 => "0 %".into(),
        s if part > 0 && s < 0.1 => "<0.1 %".into(),
        s if part < whole && s > 99.9 => ">99.9 %".into(),
        s if s < 10.0 || (part < whole && s >= 99.0) => format!("{s:.1} %"),
        s => format!("{s:.0} %"),
    }
}

/// A change in percent with `decimals` digits, from the ratio of new to old value. It has a sign unless it rounds
/// to zero: `+75.2 %`.
pub fn percent_change(ratio: f64, decimals: usize) -> String {
    let text = fixed(100.0 * (ratio - 1.0), decimals);
    let rises = text.bytes().any(|b| (b'1'..=b'9').contains(&b)) && !text.starts_with('-');
    if rises { format!("+{text} %") } else { format!("{text} %") }
}

/// A cost with three significant digits; above 100 as a whole number.
pub fn cost_words(value: f64) -> String {
    if value.abs() >= 100.0 { format!("{value:.0}") } else { significant(value, 3) }
}

/// A count with commas; from 1e12 as a power of ten with three digits.
pub fn large(n: u128) -> String {
    if n < 1_000_000_000_000 { grouped(n) } else { format!("{:.2e}", n as f64) }
}

/// A whole number with commas; from 1e12 as a power of ten.
pub fn grouped(n: u128) -> String {
    if n >= 1_000_000_000_000 {
        return significant(n as f64, 3);
    }
    let digits = n.to_string();
    let mut out = String::new();
    for (i, c) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push(',');
        }
        out.push(c);
    }
    out
}

/// The shortest text that reads back as exactly the same `f64`.
pub fn shortest(value: f64) -> String {
    let size = value.abs();
    if size != 0.0 && !(1e-5..1e16).contains(&size) && value.is_finite() {
        format!("{value:e}")
    } else {
        plain(value)
    }
}

fn plain(value: f64) -> String {
    if value == 0.0 { "0".to_string() } else { format!("{value}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn significant_digits_keep_zeros_and_round_over_the_decade() {
        assert_eq!(significant(1.4, 3), "1.40");
        assert_eq!(significant(9.996, 3), "10.0");
        assert_eq!(significant(123456.0, 3), "123000");
        assert_eq!(significant(0.1 + 0.2, 4), "0.3000");
        assert_eq!(significant(-0.00012345, 3), "-0.000123");
        assert_eq!(significant(2.1e11, 3), "2.10e11");
        assert_eq!(significant(0.0, 3), "0");
    }

    #[test]
    fn a_value_has_the_decimals_that_resolve_its_interval() {
        assert_eq!(with_ends(1.0187, [Some(1.0166), Some(1.0232)]), ["1.0187", "1.0166", "1.0232"]);
        assert_eq!(with_ends(1.2, [Some(0.4), None]), ["1.20", "0.40", "open"]);
        assert_eq!(with_ends(0.98765, [None, None]), ["0.9877", "open", "open"]);
        assert_eq!(with_ends(2.345e7, [Some(2.3e7), Some(2.4e7)]), ["2.345e7", "2.300e7", "2.400e7"]);
        assert_eq!(with_ends(1.0, [Some(1.0), Some(1.0)]), ["1.000", "1.000", "1.000"]);
    }

    #[test]
    fn fixed_never_prints_negative_zero() {
        assert_eq!(fixed(-0.001, 2), "0.00");
        assert_eq!(fixed(-0.01, 2), "-0.01");
        assert_eq!(percent_change(1.752, 1), "+75.2 %");
        assert_eq!(percent_change(0.978, 1), "-2.2 %");
        assert_eq!(percent_change(0.99999, 1), "0.0 %");
    }

    #[test]
    fn shortest_reads_back_as_the_same_number() {
        for x in [0.1, 1.0 / 3.0, 2.1e11, 1e-300, 1e300, -4.25e-7, 0.0, 1e-5, 123456789.0] {
            assert_eq!(shortest(x).parse::<f64>().ok(), Some(x));
        }
        assert_eq!(shortest(0.7e-6), "7e-7");
        assert_eq!(shortest(210e9), "210000000000");
    }

    #[test]
    fn counts_are_grouped_and_shares_never_rounded_to_nothing() {
        assert_eq!(grouped(10_536_192), "10,536,192");
        assert_eq!(grouped(999), "999");
        assert_eq!(grouped(12_300_000_000_000_000_000), "1.23e19");
        assert_eq!(percent_of(1, 5000), "<0.1 %");
        assert_eq!(percent_of(4999, 5000), ">99.9 %");
        assert_eq!(percent_of(0, 0), "0 %");
    }
}
