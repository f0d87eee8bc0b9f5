//! Scores verdicts against answer keys: a table of confusions, the coverage of the intervals, and the residuals of
//! held-out readings.

use serde_json::Value;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

/// What a set of verdicts is worth.
#[derive(Debug, Default)]
pub struct Score {
    /// Class -> (right, all).
    pub classes: BTreeMap<String, (usize, usize)>,
    /// Hidden -> said, where they differ.
    pub confusions: Vec<String>,
    /// (Hidden, said) -> how often, places left out.
    pub said: BTreeMap<(String, String), usize>,
    /// Every campaign: name, hidden effects, whether the verdict is right.
    pub each: Vec<(String, Vec<Value>, bool)>,
    /// Parameters within their interval, all.
    pub covered: (usize, usize),
    /// The same for each effect's parameter.
    pub covered_by: BTreeMap<String, (usize, usize)>,
    /// Parameters outside.
    pub misses: Vec<String>,
    /// Every parameter of an effect named at its place: campaign, effect, place, parameter, true value,
    /// estimate, ends of its interval, whether that holds.
    pub intervals: Vec<String>,
    /// Kept-out rms after, of the explained.
    pub kept_out: Vec<(String, f64)>,
}

fn read(path: &Path) -> Result<Value, Box<dyn std::error::Error>> {
    Ok(serde_json::from_str(&std::fs::read_to_string(path)?)?)
}

/// `effect@place`.
pub fn label(v: &Value) -> String {
    format!("{}@{}", v["effect"].as_str().unwrap_or("?"), v["at"].as_str().unwrap_or("?"))
}

fn known(effect: &str) -> bool {
    armwright::arm::effect::kind(effect).is_some()
}

/// Opens the keys of the named campaigns and scores what was written for them.
pub fn score(names: &[String], verdicts: &Path, keys: &Path) -> Result<Score, Box<dyn std::error::Error>> {
    let mut score = Score::default();
    for name in names {
        let verdict = read(&verdicts.join(name).join("verdict.json"))?;
        let key = read(&keys.join(format!("{name}.json")))?;
        score.add(name, &verdict, &key);
    }
    Ok(score)
}

impl Score {
    fn add(&mut self, name: &str, verdict: &Value, key: &Value) {
        let hidden: Vec<Value> = key["hidden"].as_array().cloned().unwrap_or_default();
        let hidden: Vec<Value> = hidden.into_iter().filter(|h| h["effect"] != "none").collect();
        let said: Vec<Value> = verdict["effects"].as_array().cloned().unwrap_or_default();
        let word = verdict["verdict"].as_str().unwrap_or_default();
        let unknown = hidden.iter().any(|h| !known(h["effect"].as_str().unwrap_or_default()));
        let (class, right) = match hidden.len() {
            0 => ("no gap", word == "no_gap"),
            _ if unknown => ("unknown physics", word == "unexplained" && said.is_empty()),
            1 => ("one effect", word == "explained" && said.len() == 1 && named(&hidden[0], &said)),
            _ => (
                "two effects",
                word == "explained" && said.len() == hidden.len() && hidden.iter().all(|h| named(h, &said)),
            ),
        };
        let set = name.split('-').next().unwrap_or("all");
        let entry = self.classes.entry(format!("{set}, {class}")).or_default();
        entry.0 += usize::from(right);
        entry.1 += 1;
        let list = |v: &[Value]| v.iter().map(label).collect::<Vec<_>>().join(" + ");
        *self.said.entry((kinds(&hidden, "none"), kinds(&said, word))).or_default() += 1;
        self.each.push((name.to_string(), hidden.clone(), right));
        if !right {
            self.confusions.push(format!(
                "{name}: hidden {}, said {word} {} (suspects {}) size {}",
                list(&hidden),
                list(&said),
                list(verdict["suspects"].as_array().map_or(&[], |a| a.as_slice())),
                key["size_in_sigmas"]
            ));
        }
        if word == "explained" {
            let after = verdict["kept_out"]["rms_sigma_after"].as_f64().unwrap_or(f64::NAN);
            self.kept_out.push((name.to_string(), after));
        }
        for h in &hidden {
            if let Some(s) = said.iter().find(|s| label(s) == label(h)) {
                self.cover(name, h, s);
            }
        }
    }

    fn cover(&mut self, name: &str, hidden: &Value, said: &Value) {
        let Some(parameters) = said["parameters"].as_object() else { return };
        for (parameter, interval) in parameters {
            let numbers = |v: &Value| -> Vec<Option<f64>> {
                v.as_array().map_or(vec![v.as_f64()], |a| a.iter().map(Value::as_f64).collect())
            };
            let truth = hidden.get(parameter).or_else(|| hidden["parameters"].get(parameter));
            let Some(truth) = truth else { continue };
            let (truth, value) = (numbers(truth), numbers(&interval["value"]));
            let (low, high) = (numbers(&interval["low"]), numbers(&interval["high"]));
            for (i, t) in truth.iter().enumerate() {
                let Some(t) = t else { continue };
                let end = |list: &[Option<f64>]| list.get(i).copied().flatten();
                let inside = end(&low).is_none_or(|l| l <= *t) && end(&high).is_none_or(|h| *t <= h);
                let by =
                    self.covered_by.entry(format!("{}.{parameter}", said["effect"].as_str().unwrap_or("?")));
                let by = by.or_default();
                for counts in [&mut self.covered, by] {
                    counts.0 += usize::from(inside);
                    counts.1 += 1;
                }
                let text = |x: Option<f64>| x.map_or(String::new(), |x| x.to_string());
                self.intervals.push(format!(
                    "{name},{},{},{parameter},{t},{},{},{},{inside}",
                    said["effect"].as_str().unwrap_or("?"),
                    said["at"].as_str().unwrap_or("?"),
                    text(end(&value)),
                    text(end(&low)),
                    text(end(&high)),
                ));
                if !inside {
                    self.misses.push(format!(
                        "{name} {} {parameter}: {t} not in {:?}..{:?}",
                        label(said),
                        end(&low),
                        end(&high)
                    ));
                }
            }
        }
    }

    /// The score as text.
    pub fn table(&self) -> String {
        let mut out = String::from("\nclass                       right  of\n");
        for (class, (right, all)) in &self.classes {
            out.push_str(&format!("{class:<26} {right:>6} {all:>3}\n"));
        }
        out.push_str(&format!("\nintervals that hold: {} of {}\n", self.covered.0, self.covered.1));
        for (parameter, (inside, all)) in self.covered_by.iter().filter(|(_, (inside, all))| inside < all) {
            out.push_str(&format!("  {parameter:<44} {inside:>3} of {all:>3}\n"));
        }
        self.misses.iter().for_each(|m| out.push_str(&format!("  {m}\n")));
        let worst = self.kept_out.iter().map(|k| k.1).fold(0.0, f64::max);
        let mean = self.kept_out.iter().map(|k| k.1).sum::<f64>() / self.kept_out.len().max(1) as f64;
        out.push_str(&format!("kept-out rms after: mean {mean:.3}, worst {worst:.3} sigma\n"));
        self.confusions.iter().for_each(|c| out.push_str(&format!("  {c}\n")));
        out
    }
}

impl Score {
    /// The confusion table as CSV: what was hidden, what was said, how often.
    pub fn confusion_csv(&self) -> String {
        let mut out = String::from("hidden,said,campaigns\n");
        for ((hidden, said), count) in &self.said {
            let _ = writeln!(out, "{hidden},{said},{count}");
        }
        out
    }
}

/// Names of effects without their places, in the order of the alphabet.
fn kinds(effects: &[Value], otherwise: &str) -> String {
    let mut names: Vec<&str> = effects.iter().filter_map(|e| e["effect"].as_str()).collect();
    names.sort_unstable();
    if names.is_empty() { otherwise.into() } else { names.join(" + ") }
}

/// Whether a hidden effect is said, at first choice or among at most three alternatives.
fn named(hidden: &Value, said: &[Value]) -> bool {
    said.iter().any(|s| {
        let others = s["indistinguishable_from"].as_array().cloned().unwrap_or_default();
        label(s) == label(hidden) || (others.len() <= 3 && others.iter().any(|o| label(o) == label(hidden)))
    })
}
