//! A search that is divided into shards: the joined result has the same bytes as that of one machine, for any number of
//! shards and threads. Shards that are missing or do not belong together are refused.

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
    // a manifest that a power failure emptied is a missing shard
    std::fs::write(here.path().join("parts/2-of-3/shard.json"), [0; 64]).expect("written");
    for verb in ["merge", "status"] {
        let (_, said) = armwright(here.path(), &[verb, "parts"]);
        assert!(said.contains(line), "{said}");
    }
    assert_eq!(armwright(here.path(), &words).0, 0, "the same command");
    assert_eq!(armwright(here.path(), &["merge", "parts", "--out", "out"]).0, 0);
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
    let limited =
        ["run", "study.json", "--shard", "1/2", "--gap", "1%", "--time-limit", "9", "--out", "none"];
    let (code, said) = armwright(here.path(), &limited);
    assert!(code == 2 && said.contains("goes on with the same command"), "{said}");
}

const EXACT: [&str; 2] = ["--search", "exact"];

/// The fronts of a result: of all designs and of each material.
fn fronts(here: &Path, dir: &str) -> Vec<(String, Vec<u8>)> {
    let entries = std::fs::read_dir(here.join(dir)).expect("a result").flatten();
    let names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
    let mut names: Vec<String> = names.filter(|n| n.starts_with("front.") && n.ends_with(".csv")).collect();
    names.sort();
    names.into_iter().map(|n| (n.clone(), std::fs::read(here.join(dir).join(n)).expect("a front"))).collect()
}

#[test]
fn shards_of_an_exact_search_join_to_the_fronts_of_one_machine() {
    let here = with_study();
    let here = here.path();
    assert_eq!(armwright(here, &["run", "study.json", "--search", "exact", "--out", "whole"]).0, 0);
    let whole = fronts(here, "whole");
    assert_eq!(whole.len(), 3, "all designs and two materials");
    sweep(here, "1/1", "first", &["--gap", "20%"]);
    let incumbents = ["--search", "exact", "--incumbents", "first", "--threads", "1"];
    for (shards, words) in [(1, &EXACT[..]), (3, &EXACT[..]), (2, &incumbents[..]), (60, &incumbents[..2])] {
        let parts = format!("parts{shards}");
        for k in 1..=shards {
            // of many shards a few are enough to see that designs are missing
            if shards < 10 || k % 20 == 1 {
                sweep(here, &format!("{k}/{shards}"), &format!("{parts}/{k}-of-{shards}"), words);
            }
        }
        let joined = format!("joined{shards}");
        let (code, said) = armwright(here, &["merge", &parts, "--out", &joined]);
        if shards > 10 {
            let line = "run study.json --search exact --shard 2/60 --out parts60/2-of-60";
            assert!(code == 10 && said.contains(line), "{said}");
            continue;
        }
        assert_eq!(code, 0, "{said}");
        assert!(fronts(here, &joined) == whole, "{shards} shards have another front");
        let run: Value =
            serde_json::from_slice(&std::fs::read(here.join(&joined).join("run.json")).expect("a run"))
                .expect("JSON");
        assert_eq!((run["status"].as_str(), run["gap"].as_f64()), (Some("certified"), Some(0.0)));
        let (code, said) = armwright(here, &["front", "check", &joined]);
        assert_eq!(code, 0, "{said}");
    }
    // a subtree that nobody searched is found, whatever the shards say of their number
    let file = here.join("parts3/2-of-3/shard.json");
    let mut shard = manifest(here, "parts3/2-of-3");
    let gone = shard["fronts"][0]["subtrees"].as_array_mut().expect("subtrees").pop().expect("a subtree");
    std::fs::write(&file, shard.to_string()).expect("written");
    let (code, said) = armwright(here, &["merge", "parts3", "--out", "none"]);
    assert!(code == 9 && said.contains("shard.json is not what was written: run the shard again"), "{said}");
    shard.as_object_mut().expect("keys").remove("manifest_hash");
    std::fs::write(&file, shard.to_string()).expect("written");
    let (code, said) = armwright(here, &["merge", "parts3", "--out", "none"]);
    let words = format!("subtree {gone} is in none");
    assert!(code == 9 && said.contains(&words), "{said}");
    // designs of another study are no incumbents
    let other = ["run", "study.json", "--search", "exact", "--mass-max-kg", "40", "--shard", "1/2"];
    let (code, said) = armwright(here, &[&other[..], &["--incumbents", "first", "--out", "none"]].concat());
    assert!(code == 9 && said.contains("another study_hash"), "{said}");
}

#[test]
fn shards_to_a_gap_join_to_a_front_that_has_it() {
    let here = with_study();
    let here = here.path();
    sweep(here, "1/1", "first", &["--gap", "30%"]);
    for k in 1..=2 {
        let words = ["--gap", "5%", "--incumbents", "first"];
        sweep(here, &format!("{k}/2"), &format!("parts/{k}-of-2"), &words);
    }
    let (code, said) = armwright(here, &["merge", "parts", "--out", "joined"]);
    assert_eq!(code, 0, "{said}");
    let run: Value =
        serde_json::from_slice(&std::fs::read(here.join("joined/run.json")).expect("a run")).expect("JSON");
    assert_eq!(run["gap"].as_f64(), Some(0.05));
    let (code, said) = armwright(here, &["front", "check", "joined"]);
    assert_eq!(code, 0, "{said}");
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
    let exact = ["slurm", "study.json", "--shards", "4", "--search", "exact", "--gap-first", "10%"];
    let (code, script) = armwright(here.path(), &exact);
    let (first, dependency) =
        ("--search exact --gap 0.1 --shard 1/1 --threads 1", "--dependency=\"afterok:$first\"");
    let shard = "--search exact --incumbents results/short-arm/incumbents --shard \"$SLURM";
    for words in [first, dependency, shard] {
        assert!(code == 0 && script.contains(words), "{words}: {script}");
    }
    let whole = ["run", "study.json", "--search", "exhaustive", "--out", "whole"];
    assert_eq!(armwright(here.path(), &whole).0, 0);
    assert_eq!(
        std::fs::read(here.path().join("whole/front.csv")).expect("a front"),
        std::fs::read(here.path().join(out).join("front.csv")).expect("the joined front")
    );
}
