//! `armwright compare` on small fronts that are written by hand, so that the right answers are known.

use armwright::command_line::{Cli, run};
use armwright::report::compare::Thresholds;
use armwright::report::compare::moved::moved;
use armwright::report::compare::{Answer, Comparison, Contender, Question, Row, compare};
use armwright::report::facts::{SummaryFacts, constraint_words};
use armwright::report::front_table::FrontTable;
use armwright::report::summary::{MaterialFront, SummaryInput, summary_md, terminal_summary};
use armwright::space::constraint::Constraints;
use clap::Parser;
use std::path::Path;

/// id, material of both links, deflection, mass, mode, cost.
type Design<'a> = (&'a str, [&'a str; 2], f64, f64, f64, &'a str);

const STEEL: [Design; 3] = [
    ("s1", ["Steel", "Steel"], 4.0, 50.0, 8.0, "60"),
    ("s2", ["Steel", "Steel"], 2.0, 70.0, 12.0, "90"),
    ("s3", ["Steel", "Steel"], 1.0, 100.0, 14.0, "150"),
];
const ALUMINIUM: [Design; 3] = [
    ("a1", ["Aluminium", "Aluminium"], 8.0, 30.0, 7.0, "40"),
    ("a2", ["Aluminium", "Aluminium"], 4.0, 40.0, 10.0, "80"),
    ("a3", ["Aluminium", "Aluminium"], 3.0, 60.0, 11.0, "120"),
];
const CARBON: [Design; 2] =
    [("c1", ["Carbon", "Carbon"], 3.0, 25.0, 15.0, ""), ("c2", ["Carbon", "Carbon"], 1.5, 35.0, 20.0, "")];
const ALL: [Design; 4] = [
    ("c1", ["Carbon", "Carbon"], 3.0, 25.0, 15.0, ""),
    ("m1", ["Carbon", "Steel"], 1.2, 32.0, 21.0, "70"),
    ("m2", ["Steel", "Carbon"], 1.1, 45.0, 16.0, "75"),
    ("s3", ["Steel", "Steel"], 1.0, 100.0, 14.0, "150"),
];

const COLUMNS: [&str; 11] = [
    "design_id",
    "upper_arm_material",
    "upper_arm_wall_mm",
    "forearm_material",
    "j1_gear",
    "j1_motor",
    "tip_deflection_mm",
    "mass_kg",
    "lowest_mode_hz",
    "tie_group",
    "material_cost_eur",
];

fn table(designs: &[Design]) -> FrontTable {
    let row = |(id, [upper, fore], deflection, mass, mode, cost): &Design| {
        let numbers = [deflection, mass, mode].map(|x| x.to_string());
        let [deflection, mass, mode] = &numbers;
        [*id, *upper, "3.5", *fore, "HFUC-25-100", "M1", deflection, mass, mode, "1", *cost]
            .map(String::from)
            .to_vec()
    };
    FrontTable { columns: COLUMNS.map(String::from).to_vec(), rows: designs.iter().map(row).collect() }
}

fn contenders() -> Vec<Contender> {
    vec![
        Contender { reference: true, ..Contender::new("all", table(&ALL)) },
        Contender::new("Steel", table(&STEEL)),
        Contender::new("Aluminium", table(&ALUMINIUM)),
        Contender::new("Carbon", table(&CARBON)),
    ]
}

fn at(deflection_mm: &[f64], mass_kg: &[f64], mode_hz: &[f64]) -> Thresholds {
    Thresholds { deflection_mm: deflection_mm.into(), mass_kg: mass_kg.into(), mode_hz: mode_hz.into() }
}

fn row(comparison: &Comparison, question: Question) -> &Row {
    comparison.rows.iter().find(|r| r.question == question).expect("asked")
}

/// Design of each front, whether it keeps the limit, and whether it wins.
fn answers(row: &Row) -> Vec<(&str, &str, bool, bool)> {
    fn id(a: &Answer) -> &str {
        a.design.as_ref().map_or("", |d| d.design_id.as_str())
    }
    row.answers.iter().map(|a| (a.label.as_str(), id(a), a.reached, a.winner)).collect()
}

#[test]
fn the_lightest_at_a_deflection_is_found_and_named_with_its_lead() {
    let comparison = compare(&contenders(), &at(&[4.0], &[], &[]));
    let row = row(&comparison, Question::LightestAtDeflection);
    let expected = [
        ("all", "c1", true, false),
        ("Steel", "s1", true, false),
        ("Aluminium", "a2", true, false),
        ("Carbon", "c1", true, true),
    ];
    assert_eq!(answers(row), expected);
    assert_eq!(
        row.sentence,
        "Tip deflection at most 4 mm: Carbon is lightest with 25.00 kg (design c1), 37.5 % lighter than \
         Aluminium (40.00 kg)."
    );
    assert_eq!(comparison.rows.len(), 1, "only what is asked for");
}

#[test]
fn a_front_that_cannot_keep_a_limit_says_how_near_it_gets() {
    let comparison = compare(&contenders(), &at(&[2.0, 0.5], &[], &[]));
    let two = row(&comparison, Question::LightestAtDeflection);
    assert_eq!(answers(two)[2], ("Aluminium", "a3", false, false));
    assert!(two.sentence.contains("50.0 % lighter than Steel (70.00 kg); materials mixed reach 32.00 kg"));
    let text = comparison.to_text().split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(text.contains("Cannot reach ≤ 2 mm; nearest: Aluminium (3.000 mm, design a3)."), "{text}");
    assert!(text.contains("Tip deflection at most 0.5 mm: none reaches it; nearest is Steel with 1.000 mm."));
}

#[test]
fn at_a_mass_the_stiffest_and_the_highest_mode_are_found() {
    let comparison = compare(&contenders(), &at(&[], &[60.0], &[]));
    let stiffest = row(&comparison, Question::StiffestAtMass);
    assert_eq!(
        answers(stiffest)[1..],
        [("Steel", "s1", true, false), ("Aluminium", "a3", true, false), ("Carbon", "c2", true, true)]
    );
    let highest = row(&comparison, Question::HighestModeAtMass);
    assert!(highest.sentence.starts_with(
        "Mass at most 60 kg: Carbon has the highest lowest mode with 20.00 Hz (design c2), 81.8 % higher than \
         Aluminium (11.00 Hz); materials mixed reach 21.00 Hz, 5.0 % higher."
    ));
}

#[test]
fn a_limit_on_the_mode_asks_for_the_lightest_above_it() {
    let comparison = compare(&contenders(), &at(&[], &[], &[12.0]));
    let row = row(&comparison, Question::LightestAtMode);
    assert_eq!(
        answers(row)[1..],
        [("Steel", "s2", true, false), ("Aluminium", "a3", false, false), ("Carbon", "c1", true, true)]
    );
}

#[test]
fn equal_answers_win_together() {
    let twins = [Contender::new("A", table(&STEEL)), Contender::new("B", table(&STEEL))];
    let comparison = compare(&twins, &at(&[2.0], &[], &[]));
    let row = row(&comparison, Question::LightestAtDeflection);
    assert!(row.answers.iter().all(|a| a.winner));
    assert!(row.sentence.contains("A and B are lightest with 70.00 kg"), "{}", row.sentence);
}

#[test]
fn chosen_limits_are_round_and_most_fronts_keep_them() {
    let comparison = compare(&contenders(), &Thresholds::default());
    for question in Question::ALL {
        let rows: Vec<&Row> = comparison.rows.iter().filter(|r| r.question == question).collect();
        assert!(!rows.is_empty(), "{question:?}");
        for row in rows {
            let reached = row.answers.iter().filter(|a| a.reached && !a.reference).count();
            assert!(reached >= 2, "{question:?} at {}: {reached} of 3", row.limit);
        }
    }
}

#[test]
fn csv_has_every_answer_and_json_the_same() {
    let comparison = compare(&contenders(), &at(&[2.0], &[60.0], &[12.0]));
    let csv = comparison.to_csv();
    assert_eq!(csv.lines().count(), 1 + 4 * 3 + 4 * 4);
    assert!(csv.contains("\nlightest_at_deflection,2,mm,Steel,no,yes,no,s2,2,70,12,90\n"), "{csv}");
    assert!(csv.contains("\nlightest_at_mode,12,Hz,Aluminium,no,no,no,a3,3,60,11,120\n"));
    let json = serde_json::to_value(&comparison).expect("serializes");
    assert_eq!(json["rows"][0]["answers"][3]["design"]["design_id"], "c2");
    assert_eq!(json["rows"][0]["question"], "lightest_at_deflection");
}

#[test]
fn text_tables_fit_and_empty_fronts_stand_as_none() {
    let mut fronts = contenders();
    fronts.push(Contender::new("Unobtainium (never in stock, whatever one asks)", table(&[])));
    let comparison = compare(&fronts, &at(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0], &[], &[]));
    let text = comparison.to_text();
    assert!(text.lines().all(|l| l.chars().count() <= 80), "{text}");
    assert!(text.contains("Unobtainium") && text.contains("none"));
    assert!(comparison.to_markdown().contains("Unobtainium (never in stock, whatever one asks)"));
}

#[test]
fn what_moved_tells_designs_apart_by_their_choices() {
    // the same arms under other names, one judged anew, one gone, one new
    let mut later = table(&STEEL);
    later.rows[0][0] = "renamed".into();
    later.rows[1][7] = "71".into();
    later.rows[2][2] = "9".into();
    later.rows[0][2] = "1".into();
    let mut before = table(&STEEL);
    before.rows[0][2] = "1".into();
    before.rows[2][2] = "8".into();
    let m = moved(&Contender::new("old", before), &Contender::new("new", later));
    assert_eq!((m.unchanged, m.judged_anew, m.came, m.went), (1, 1, 1, 1));
    assert!(m.words.contains("Lightest still 50.00 kg"), "{}", m.words);
}

fn compare_cli(line: &[&str]) -> Result<String, String> {
    let cli = Cli::try_parse_from([&["armwright", "compare"], line].concat()).map_err(|e| e.to_string())?;
    run(cli).map(|answer| answer.text).map_err(|e| e.to_string())
}

fn results(dir: &Path, study: &str) {
    std::fs::create_dir_all(dir).expect("a temporary folder");
    let write = |name: &str, bytes: &[u8]| std::fs::write(dir.join(name), bytes).expect("writable");
    write("front.csv", &table(&ALL).to_csv());
    write("front.steel.csv", &table(&STEEL).to_csv());
    write("front.carbon.csv", &table(&CARBON).to_csv());
    let materials = r#"[{"name": "Steel", "slug": "steel"}, {"name": "Carbon", "slug": "carbon"}]"#;
    let version = env!("CARGO_PKG_VERSION");
    write(
        "run.json",
        format!(r#"{{"study": "{study}", "tool_version": "{version}", "materials": {materials}}}"#)
            .as_bytes(),
    );
}

#[test]
fn one_result_folder_compares_its_materials_and_writes_three_files() {
    let temp = tempfile::tempdir().expect("a temporary folder");
    results(temp.path(), "s");
    let out = temp.path().join("made/here");
    let (dir, out_text) = (temp.path().display().to_string(), out.display().to_string());
    let text = compare_cli(&[&dir, "--deflection-mm", "2,4", "--out", &out_text]).expect("compared");
    assert!(text.contains("all ") && text.contains("Carbon is lightest"), "{text}");
    for name in ["compare.md", "compare.csv", "compare.svg"] {
        assert!(out.join(name).is_file(), "{name}");
    }
    let json = compare_cli(&[&dir, "--json"]).expect("compared");
    let json: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!(json["reach"].as_array().map(Vec::len), Some(3));
}

#[test]
fn two_runs_of_one_study_say_what_moved_and_front_files_are_taken() {
    let temp = tempfile::tempdir().expect("a temporary folder");
    let (a, b) = (temp.path().join("a/out"), temp.path().join("b/out"));
    results(&a, "s");
    results(&b, "s");
    std::fs::write(b.join("front.csv"), table(&ALL[1..]).to_csv()).expect("writable");
    let path = |p: &Path| p.display().to_string();
    let text = compare_cli(&[&path(&a), &path(&b)]).expect("compared").replace('\n', " ");
    assert!(text.contains("From a/out to b/out:") && text.contains("25.00 kg to 32.00 kg (+28 %)"), "{text}");
    let files = [path(&a.join("front.steel.csv")), path(&a.join("front.carbon.csv"))];
    let text = compare_cli(&[&files[0], &files[1]]).expect("compared");
    assert!(text.contains("\n  steel ") && !text.contains("From "), "{text}");
}

/// Writes that another version made a result.
fn made_by(dir: &Path, version: &str) {
    let file = dir.join("run.json");
    let text = std::fs::read_to_string(&file).expect("a run");
    let other = format!(r#""tool_version": "{version}""#);
    std::fs::write(
        &file,
        text.replace(&format!(r#""tool_version": "{}""#, env!("CARGO_PKG_VERSION")), &other),
    )
    .expect("writable");
}

#[test]
fn results_and_front_files_of_an_earlier_version_are_refused_with_the_reason() {
    let temp = tempfile::tempdir().expect("a temporary folder");
    let (a, b) = (temp.path().join("a"), temp.path().join("b"));
    results(&a, "s");
    results(&b, "s");
    made_by(&b, "0.1.0");
    let [a, b, file] = [a, b.clone(), b.join("front.steel.csv")].map(|p| p.display().to_string());
    for line in [[&b, &b], [&a, &b], [&a, &file]] {
        let line = if line[0] == line[1] { &line[..1] } else { &line[..] };
        let line: Vec<&str> = line.iter().map(|word| word.as_str()).collect();
        let cli = Cli::try_parse_from([&["armwright", "compare"], line.as_slice()].concat()).expect("words");
        let failure = run(cli).expect_err("an earlier version");
        assert_eq!(failure.exit_code(), 3, "{failure}");
        let said = failure.to_string();
        assert!(said.contains("made by version 0.1.0, before output bearings were modelled"), "{said}");
        assert!(said.contains("run the study again"), "{said}");
    }
}

#[test]
fn errors_name_the_folder_or_file_and_what_is_wrong() {
    let temp = tempfile::tempdir().expect("a temporary folder");
    let dir = temp.path().display().to_string();
    assert!(compare_cli(&["/no/such"]).expect_err("missing").contains("/no/such: no such file or folder"));
    let error = compare_cli(&[&dir]).expect_err("not a result");
    assert!(error.contains("is not a result folder: it has no front.csv"), "{error}");
    results(temp.path(), "s");
    std::fs::remove_file(temp.path().join("front.carbon.csv")).expect("there");
    assert!(compare_cli(&[&dir]).expect_err("a front is missing").contains("front.carbon.csv"));
    let file = temp.path().join("other.csv");
    std::fs::write(&file, "a,b\n1,2\n").expect("writable");
    let error = compare_cli(&[&file.display().to_string()]).expect_err("no front");
    assert!(error.contains("other.csv has no column"), "{error}");
    assert!(compare_cli(&[&dir, "--mass-kg", "40,-1"]).expect_err("negative").contains("-1 is not greater"));
}

fn input() -> SummaryInput {
    let material = |name: &str, cost, designs: &[Design]| MaterialFront {
        ties_listed: true,
        status: "complete".into(),
        name: name.into(),
        cost_eur_per_kg: cost,
        front: table(designs),
    };
    SummaryInput {
        facts: SummaryFacts {
            study: "demo".into(),
            question: "Which?".into(),
            status: "complete".into(),
            designs_total: 12_000_000,
            designs_evaluated: 10_000_000,
            designs_excluded: 2_000_000,
            elapsed_s: 20.0,
            threads: 2,
            constraints: constraint_words(&Constraints {
                mass_max_kg: Some(120.0),
                ..Constraints::default()
            }),
            cases: vec!["stretched".into()],
            not_checked: vec!["M9: peak torque unknown".into()],
            results: "results/demo".into(),
            ..SummaryFacts::default()
        },
        overall: table(&ALL),
        materials: vec![
            material("Steel", Some(1.2), &STEEL),
            material("Aluminium", Some(4.0), &ALUMINIUM),
            material("Carbon", None, &CARBON),
            material("Lead", None, &[]),
        ],
        budgets: Vec::new(),
    }
}

#[test]
fn the_summary_answers_who_wins_where() {
    let text = summary_md(&input());
    for words in [
        "Carbon gives the lightest arm (25.00 kg); Steel gives the stiffest (1.000 mm); a mix of Carbon and \
         Steel gives the highest lowest mode (21.00 Hz).",
        "is design m1 (a mix of Carbon and Steel): 32.00 kg, 1.200 mm, 21.00 Hz; the front has 4 designs, 50 % of \
         them of mixed materials.",
        "- lightest (c1): upper_arm 3.5 mm Carbon; forearm Carbon; j1 HFUC-25-100 + M1",
        "12,000,000 designs: 10,000,000 evaluated, 2,000,000 excluded by a limit; search complete.",
        "- <!-- timing -->12,000,000 designs in 20.0 s on 2 threads, 500,000 evaluated/s<!-- /timing -->",
        "Constraints: mass at most 120 kg.",
        "- M9: peak torque unknown",
        "armwright design results/demo m1\n",
    ] {
        assert!(text.contains(words), "{words}\nnot in\n{text}");
    }
}

#[test]
fn a_material_that_a_link_may_not_be_of_has_no_row_but_a_reason() {
    let mut input = input();
    let reason = |input: &SummaryInput| -> Vec<String> {
        let text = summary_md(input);
        let lines = text.lines().filter(|l| l.starts_with("| Lead") || l.contains("of Lead alone"));
        lines.map(|line| line.split("  ").next().unwrap_or_default().to_string()).collect()
    };
    assert_eq!(reason(&input), ["| Lead", "No design of Lead alone meets the limits."]);
    input.facts.materials_of_some_links = [("Lead".to_string(), vec!["forearm".to_string()])].into();
    let words = "No design is of Lead alone: the study does not offer it for forearm.";
    assert_eq!(reason(&input), [words]);
    assert!(terminal_summary(&input).replace('\n', " ").contains(words));
}

#[test]
fn the_materials_table_has_reach_and_share() {
    let text = terminal_summary(&input());
    let line = |name: &str| {
        let line = text.lines().find(|l| l.starts_with(&format!("{name} ")) && l.contains('%')).unwrap_or("");
        line.split_whitespace().collect::<Vec<_>>().join(" ")
    };
    assert_eq!(line("Steel"), "Steel 3 50.00 1.000 14.00 25 % 1.20");
    assert_eq!(line("Aluminium"), "Aluminium 3 30.00 3.000 11.00 0 % 4.00");
    assert_eq!(line("Lead"), "Lead 0 none none none 0 % unknown");
    assert_eq!(line("mixed"), "mixed 2 32.00 1.100 21.00 50 %");
    assert!(text.lines().all(|l| l.chars().count() <= 80), "{text}");
}

#[test]
fn a_study_without_a_design_is_summed_up_too() {
    let mut none = input();
    none.overall = table(&[]);
    assert!(summary_md(&none).contains("**Answer.** No design meets the constraints."));
    none.facts.status = "interrupted".into();
    assert!(terminal_summary(&none).contains("before the search stopped"));
}
