//! A search in shards: the joined result has the bytes of one machine, for any number of shards and threads; what does not
//! belong together or is missing is refused.

use crate::front_check::STUDY;
use crate::running::armwright;
use serde_json::Value;
use std::path::Path;
use std::process::Command;

/// Exit code and everything that was said.
fn with_study() -> tempfile::TempDir {
    let here = tempfile::tempdir().expect("a folder");
    std::fs::write(here.path().join("study.json"), STUDY).expect("written");
    here
}

fn sweep(here: &Path, shard: &str, out: &str, more: &[&str]) -> String {
    let words = ["run", "study.json", "--shard", shard, "--out", out];
    let (code, said) = armwright(here, &[&words[..], more].concat());
    assert_eq!(code, 0, "{said}");
    said
}

fn manifest(here: &Path, dir: &str) -> Value {
    let text = std::fs::read_to_string(here.join(dir).join("shard.json")).expect("a manifest");
    serde_json::from_str(&text).expect("JSON")
}

#[test]
fn shards_join_to_the_result_of_one_machine_for_any_number_of_shards_and_threads() {
    let here = with_study();
    let whole = ["run", "study.json", "--search", "exhaustive", "--out", "whole"];
    assert_eq!(armwright(here.path(), &whole).0, 0);
    for (shards, threads) in [(1, "1"), (3, "2"), (7, "1")] {
        let parts = format!("parts{shards}");
        let mut covered = 0;
        for k in 1..=shards {
            sweep(
                here.path(),
                &format!("{k}/{shards}"),
                &format!("{parts}/{k}-of-{shards}"),
                &["--threads", threads],
            );
            let shard = manifest(here.path(), &format!("{parts}/{k}-of-{shards}"));
            assert_eq!((shard["shard"][0].as_u64(), shard["proved"].as_bool()), (Some(k), Some(true)));
            assert_eq!(shard["range"][0].as_u64(), Some(covered), "ranges follow each other");
            covered = shard["range"][1].as_u64().expect("an end");
        }
        assert_eq!(
            Some(covered),
            manifest(here.path(), &format!("{parts}/1-of-{shards}"))["designs_total"].as_u64()
        );
        // twice, and in any order of the folders
        let joined = format!("joined{shards}");
        for _ in 0..2 {
            let (code, said) = armwright(here.path(), &["merge", &parts, "--out", &joined]);
            assert_eq!(code, 0, "{said}");
        }
        let (code, said) = armwright(here.path(), &["check", "--same", "whole", &joined]);
        assert_eq!(code, 0, "{said}");
    }
    let reversed =
        ["merge", "parts3/3-of-3", "parts3/1-of-3", "parts3/2-of-3", "parts3/1-of-3", "--out", "again"];
    assert_eq!(armwright(here.path(), &reversed).0, 0);
    assert_eq!(armwright(here.path(), &["check", "--same", "whole", "again"]).0, 0);
    let (code, said) = armwright(here.path(), &["front", "check", "again"]);
    assert_eq!(code, 0, "{said}");
    // the comparison sees a single digit
    let file = here.path().join("again/front.csv");
    let text = std::fs::read_to_string(&file).expect("a front").replacen('1', "2", 1);
    std::fs::write(&file, text).expect("written");
    let (code, said) = armwright(here.path(), &["check", "--same", "whole", "again"]);
    assert!(code == 9 && said.contains("front.csv differs"), "{said}");
}

#[test]
fn a_missing_shard_is_named_with_the_command_that_makes_it() {
    let here = with_study();
    for k in [1, 3] {
        sweep(here.path(), &format!("{k}/3"), &format!("parts/{k}-of-3"), &[]);
    }
    let line = "armwright run study.json --shard 2/3 --out parts/2-of-3";
    let (code, said) = armwright(here.path(), &["merge", "parts", "--out", "out"]);
    assert!(code == 10 && said.contains(line), "{said}");
    assert!(!here.path().join("out").exists(), "nothing is half-joined");
    let (code, said) = armwright(here.path(), &["status", "parts"]);
    assert!(code == 0 && said.contains("2 of 3 shards") && said.contains(line), "{said}");
    let words: Vec<&str> = line.split(' ').skip(1).collect();
    assert_eq!(armwright(here.path(), &words).0, 0, "the command as it is printed");
    assert_eq!(armwright(here.path(), &["merge", "parts", "--out", "out"]).0, 0);
    // a shard that is there is not swept twice, so an array can be submitted again as a whole
    assert!(sweep(here.path(), "2/3", "parts/2-of-3", &[]).contains("has this shard already"));
}

#[test]
fn shards_of_other_inputs_and_damaged_shards_are_refused() {
    let here = with_study();
    sweep(here.path(), "1/2", "parts/1-of-2", &[]);
    sweep(here.path(), "2/2", "parts/2-of-2", &["--mass-max-kg", "40"]);
    let (code, said) = armwright(here.path(), &["merge", "parts", "--out", "out"]);
    assert!(code == 9 && said.contains("study_hash"), "{said}");
    std::fs::remove_dir_all(here.path().join("parts/2-of-2")).expect("removed");
    sweep(here.path(), "2/3", "parts/2-of-3", &[]);
    let (code, said) = armwright(here.path(), &["merge", "parts", "--out", "out"]);
    assert!(code == 9 && said.contains("one of 2 and one of 3"), "{said}");
    std::fs::remove_dir_all(here.path().join("parts/2-of-3")).expect("removed");
    sweep(here.path(), "2/2", "parts/2-of-2", &[]);
    let file = here.path().join("parts/2-of-2/candidates.csv");
    let text = std::fs::read_to_string(&file).expect("candidates");
    std::fs::write(&file, &text[..text.len() - 2]).expect("written");
    let (code, said) = armwright(here.path(), &["merge", "parts", "--out", "out"]);
    assert!(code == 9 && said.contains("run the shard again"), "{said}");
    sweep(here.path(), "2/2", "parts/2-of-2", &[]);
    assert_eq!(armwright(here.path(), &["merge", "parts", "--out", "out"]).0, 0);
    assert_eq!(armwright(here.path(), &["merge", ".git", "--out", "out"]).0, 7, "no folder");
    for wrong in ["0/3", "4/3", "x", "1/0"] {
        let words = ["run", "study.json", "--shard", wrong, "--out", "none"];
        assert_eq!(armwright(here.path(), &words).0, 2, "{wrong}");
    }
    let exact = ["run", "study.json", "--shard", "1/2", "--search", "exact", "--out", "none"];
    let (code, said) = armwright(here.path(), &exact);
    assert!(code == 2 && said.contains("one machine"), "{said}");
}

#[cfg(unix)]
#[test]
fn the_slurm_script_is_read_by_a_shell_and_ends_in_exec() {
    let here = with_study();
    let out = "a folder/it's";
    let (code, script) =
        armwright(here.path(), &["slurm", "study.json", "--shards", "4", "--cpus", "2", "--out", out]);
    assert_eq!(code, 0, "{script}");
    assert!(script.contains("--array=1-4") && script.contains("--kill-on-invalid-dep=yes"), "{script}");
    // an sbatch that runs each task of the array at once, and the merge after it
    let sbatch = r#"#!/bin/sh
cat > job
case $(sed -n 's/^#SBATCH --array=1-//p' job) in
  '') sh job >&2 ;;
  *) for k in 1 2 3 4; do SLURM_ARRAY_TASK_ID=$k sh job >&2; done ;;
esac
echo 7
"#;
    use std::os::unix::fs::PermissionsExt;
    let tool = here.path().join("sbatch");
    std::fs::write(&tool, sbatch).expect("written");
    std::fs::set_permissions(&tool, std::fs::Permissions::from_mode(0o755)).expect("set");
    std::fs::write(here.path().join("submit.sh"), script).expect("written");
    let program = Path::new(env!("CARGO_BIN_EXE_armwright")).parent().expect("a folder");
    let path = std::env::var("PATH").unwrap_or_default();
    let path = format!("{}:{}:{path}", here.path().display(), program.display());
    let output = Command::new("sh").arg("submit.sh").current_dir(here.path()).env("PATH", path).output();
    let output = output.expect("a shell");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(String::from_utf8_lossy(&output.stdout), "shards 7, merge 7\n");
    let whole = ["run", "study.json", "--search", "exhaustive", "--out", "whole"];
    assert_eq!(armwright(here.path(), &whole).0, 0);
    assert_eq!(
        std::fs::read(here.path().join("whole/front.csv")).expect("a front"),
        std::fs::read(here.path().join(out).join("front.csv")).expect("the joined front")
    );
}
