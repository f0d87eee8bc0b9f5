//! The pages in a real browser: they report no errors, their links work, and their numbers equal those of the files.
//! Without Chromium the tests print this and pass; `scripts/test` installs Chromium where it may.
//!
//! `ARMWRIGHT_SCREENSHOTS=DIR cargo test --test program pages` also writes pictures of the pages into a folder.

use crate::browser::Browser;
use armwright::report::facts::SummaryFacts;
use armwright::report::front_table::FrontTable;
use armwright::report::html::study::StudyPage;
use armwright::report::number::significant;
use armwright::report::summary::{MaterialFront, SummaryInput};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Most that a page may weigh \[bytes\].
const MOST_BYTES: u64 = 2_000_000;

fn project(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(name)
}

fn armwright(arguments: &[&str]) {
    let run =
        Command::new(env!("CARGO_BIN_EXE_armwright")).args(arguments).output().expect("the program starts");
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
}

/// Runs the bench arm's study with a short list of drives, so that it takes a moment and not a minute.
fn bench_arm(folder: &Path) -> PathBuf {
    let text = std::fs::read_to_string(project("examples/bench-arm.json")).expect("the study");
    let mut study: Value = serde_json::from_str(&text).expect("JSON");
    study["drives"] =
        json!({"gear_series": ["CSG"], "ratios": [100], "motor_models": ["ILM70x18", "ILM85x26"]});
    let (file, out) = (folder.join("bench.json"), folder.join("bench"));
    std::fs::write(&file, study.to_string()).expect("the study is written");
    armwright(&["run", file.to_str().expect("a path"), "--out", out.to_str().expect("a path")]);
    out
}

/// Rows of a front by column.
fn column<'a>(front: &'a FrontTable, name: &str) -> Vec<&'a str> {
    let index = front.column(name).expect("the column");
    front.rows.iter().map(|r| r[index].as_str()).collect()
}

/// Nothing was asked of the network, nothing went wrong, and the page is light.
fn quiet(browser: &Browser, page: &Path) {
    assert_eq!(browser.complaints(), Vec::<String>::new());
    let bytes = std::fs::metadata(page).expect("the page").len();
    assert!(bytes < MOST_BYTES, "{bytes} bytes");
    let mark = browser.value("performance.getEntriesByName('interactive')[0].startTime");
    println!(
        "{}: {bytes} bytes, interactive after {:.0} ms",
        page.display(),
        mark.as_f64().unwrap_or_default()
    );
}

/// Saves a picture where the environment asks for one.
fn picture(browser: &Browser, name: &str, clip: Value) {
    if let Some(folder) = std::env::var_os("ARMWRIGHT_SCREENSHOTS") {
        std::fs::write(Path::new(&folder).join(name), browser.picture(clip)).expect("the picture is written");
    }
}

/// The whole page, or its upper part.
fn upper(browser: &Browser, width: u32, most: u64) -> Value {
    let height = browser.count("document.documentElement.scrollHeight").min(most as usize);
    json!({"x": 0, "y": 0, "width": width, "height": height, "scale": 1})
}

/// Pictures of a page in all its forms.
fn pictures(browser: &Browser, name: &str) {
    for (form, width, scheme) in [("light", 1280, "light"), ("dark", 1280, "dark"), ("phone", 390, "light")] {
        browser.size(width, 900);
        browser.media("screen", scheme);
        std::thread::sleep(std::time::Duration::from_millis(300));
        let clip = upper(browser, width, 7000);
        picture(browser, &format!("{name}-{form}.png"), clip);
    }
    browser.media("", "light");
    if let Some(folder) = std::env::var_os("ARMWRIGHT_SCREENSHOTS") {
        std::fs::write(Path::new(&folder).join(format!("{name}.pdf")), browser.printed()).expect("the print");
    }
    browser.size(1280, 900);
}

#[test]
fn the_page_of_a_study_shows_the_numbers_of_its_front() {
    let Some(browser) = Browser::start() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let results = bench_arm(folder.path());
    let front = FrontTable::read(&results.join("front.csv")).expect("the front");
    let page = results.join("report.html");
    browser.size(1280, 900);
    browser.open(&page);
    assert_eq!(browser.text("#count"), format!("{0} of {0} designs selected", front.rows.len()));
    // the table of the page against the file, row by row
    let shown = browser.value(
        "[...document.querySelectorAll('#designs tbody tr')].map(tr => [...tr.cells].slice(0, 4).map(c => c.textContent))",
    );
    let rows = shown.as_array().expect("rows");
    assert!(rows.len() >= 8);
    for (row, shown) in rows.iter().enumerate() {
        let exact = |name: &str| significant(column(&front, name)[row].parse().expect("a number"), 5);
        let expected = [
            column(&front, "design_id")[row].to_string(),
            exact("mass_kg"),
            exact("tip_deflection_mm"),
            exact("lowest_mode_hz"),
        ];
        assert_eq!(*shown, json!(expected), "row {row}");
    }
    // the cards against the file and the terminal's summary
    let cards = browser.value(
        "[...document.querySelectorAll('.pick')].map(p => [p.dataset.design, \
         ...[...p.querySelectorAll('[data-number]')].map(n => n.textContent.trim())])",
    );
    let summary = std::fs::read_to_string(results.join("summary.md")).expect("the summary");
    for card in cards.as_array().expect("cards") {
        let row =
            column(&front, "design_id").iter().position(|id| *id == card[0]).expect("a design of the front");
        let exact = |name: &str| significant(column(&front, name)[row].parse().expect("a number"), 4);
        for (i, (name, unit)) in
            [("tip_deflection_mm", "mm"), ("mass_kg", "kg"), ("lowest_mode_hz", "Hz")].into_iter().enumerate()
        {
            assert_eq!(card[i + 1], format!("{} {unit}", exact(name)));
            assert!(summary.contains(&exact(name)), "{} in summary.md", exact(name));
        }
    }
    quiet(&browser, &page);
    pictures(&browser, "study");
}

/// Draws the plots of a study once more and gives the names of picks that are nearer to the ring of another pick than to
/// their own, without a line from their own ring to them.
const NAMES_AT_WRONG_RINGS: &str = r#"(() => {
  const drawing = CanvasRenderingContext2D.prototype, { arc, lineTo, strokeText } = drawing;
  const rings = [], names = [];
  let line = null;
  drawing.arc = function (x, y, r, ...rest) { if (r === 7) rings.push({ at: this, x, y }); arc.call(this, x, y, r, ...rest); };
  drawing.lineTo = function (x, y) { line = { at: this, x, y }; lineTo.call(this, x, y); };
  drawing.strokeText = function (words, x, y) {
    if (this.font.startsWith("600 12px")) names.push({ at: this, words, own: rings.at(-1), line, box: [x, y - 11, x + this.measureText(words).width, y + 3] });
    line = null;
    strokeText.call(this, words, x, y);
  };
  document.getElementById("reset").click();
  Object.assign(drawing, { arc, lineTo, strokeText });
  const distance = (p, b) => Math.hypot(Math.max(b[0] - p.x, 0, p.x - b[2]), Math.max(b[1] - p.y, 0, p.y - b[3]));
  const wrong = names.filter((n) => rings.some((r) => r.at === n.at && Math.hypot(r.x - n.own.x, r.y - n.own.y) > 1 && distance(r, n.box) < 1.5 * distance(n.own, n.box)) && !(n.line && n.line.at === n.at && distance(n.line, n.box) < 4));
  return [names.length, wrong.map((n) => n.words)];
})()"#;

#[test]
fn the_views_of_a_study_follow_pointer_brush_filters_and_keys() {
    let Some(browser) = Browser::start() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let results = bench_arm(folder.path());
    let front = FrontTable::read(&results.join("front.csv")).expect("the front");
    browser.size(1280, 900);
    browser.open(&results.join("report.html"));
    let selected = || -> usize {
        browser.text("#count").split(' ').next().and_then(|n| n.parse().ok()).expect("a count")
    };
    // every name of a pick belongs to its ring, in a plot that has room and in one that has little
    for width in [390, 1280] {
        browser.size(width, 900);
        browser.keep_trying("names at their rings", || {
            let [count, wrong] = [0, 1].map(|i| browser.value(NAMES_AT_WRONG_RINGS)[i].clone());
            count.as_u64().is_some_and(|count| count >= 4) && wrong == json!([])
        });
    }
    // keys: the first design of the front, then the next
    browser.value("document.getElementById('by-deflection').focus()");
    for row in 0..2 {
        browser.key("ArrowRight");
        assert_eq!(
            browser.value("document.getElementById('reading').dataset.design"),
            column(&front, "design_id")[row]
        );
        let mass: f64 = column(&front, "mass_kg")[row].parse().expect("a number");
        assert!(browser.text("#reading").contains(&format!("mass {} kg", significant(mass, 5))));
    }
    browser.key("Escape");
    // the pointer: no point of the grid is further than a plot's reach from the next, so one finds a design
    browser.keep_trying("a design under the pointer", || {
        let [left, top, width, height] = browser.place("#by-deflection");
        let steps = |length: f64| (0..).map(|i| 30.0 * f64::from(i)).take_while(move |&at| at < length);
        steps(height).flat_map(|y| steps(width).map(move |x| (left + x, top + y))).any(|(x, y)| {
            browser.mouse("mouseMoved", x, y);
            browser.value("new Promise(r => requestAnimationFrame(() => requestAnimationFrame(() => r(1))))");
            browser.text("#reading").starts_with("design ")
        })
    });
    // a brush selects fewer
    let fewer = |what: &str, brush: &dyn Fn()| {
        browser.keep_trying(what, || {
            browser.click("#reset");
            brush();
            (1..front.rows.len()).contains(&selected())
        });
        browser.click("#reset");
        assert_eq!(selected(), front.rows.len());
    };
    fewer("a brush in a plot", &|| {
        let [left, top, width, height] = browser.place("#by-deflection");
        browser.mouse("mouseMoved", left + width / 2.0, top + 2.0);
        browser.drag((left + 60.0, top + 40.0), (left + width * 0.4, top + height - 60.0));
    });
    fewer("a brush along an axis of choices", &|| {
        let [left, top, _, height] = browser.place("#by-choice");
        browser.drag((left + 122.0, top + height - 20.0), (left + 122.0, top + height * 0.6));
    });
    // the legend as a filter: what is left are the designs of other materials
    browser.click("#legend button:nth-child(2)");
    let (upper, fore) = (column(&front, "upper_arm_material"), column(&front, "forearm_material"));
    let name = "Aluminium 6061-T6";
    let expected = upper.iter().zip(&fore).filter(|(a, b)| **a != name || **b != name).count();
    assert_eq!(selected(), expected);
    browser.click("#reset");
    // a number as a filter
    browser.value(
        "(() => { const n = document.querySelector('[aria-label=\"mass [kg], most\"]'); n.value = '10'; \
         n.dispatchEvent(new Event('change')); })()",
    );
    let light =
        column(&front, "mass_kg").iter().filter(|m| m.parse::<f64>().expect("a number") <= 10.0).count();
    assert_eq!(selected(), light);
    // the picks
    for tab in browser
        .value("[...document.querySelectorAll('.tabs button')].map(b => b.id)")
        .as_array()
        .expect("tabs")
    {
        let tab = tab.as_str().expect("an id");
        browser.click(&format!("#{tab}"));
        let open =
            browser.value("[...document.querySelectorAll('.pick')].filter(p => !p.hidden).map(p => p.id)");
        assert_eq!(open, json!([tab.replace("tab-", "pick-")]));
    }
    assert_eq!(browser.complaints(), Vec::<String>::new());
}

#[test]
fn a_page_can_be_read_on_a_phone_on_paper_and_without_its_program() {
    let Some(browser) = Browser::start() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let results = bench_arm(folder.path());
    let page = results.join("report.html");
    browser.size(390, 844);
    browser.open(&page);
    browser.until("document.documentElement.scrollWidth <= 390");
    // on paper every pick and the still pictures are there, and nothing that only works on a screen
    browser.media("print", "light");
    let shown = |selector: &str| {
        let all = format!(
            "[...document.querySelectorAll({})].every(n => getComputedStyle(n).display !== 'none' && \
             getComputedStyle(n).visibility === 'visible')",
            json!(selector)
        );
        browser.value(&all) == json!(true)
    };
    assert!(shown(".pick") && shown(".stills svg"));
    assert!(browser.value("getComputedStyle(document.getElementById('views')).display") == json!("none"));
    assert!(browser.printed().starts_with(b"%PDF"));
    // without the program all is on the page
    browser.media("", "light");
    browser.call("Emulation.setScriptExecutionDisabled", json!({"value": true}));
    browser.call("Page.navigate", json!({"url": format!("file://{}", page.display())}));
    browser
        .until("document.readyState === 'complete' && document.documentElement?.dataset.ready === undefined");
    assert!(shown(".pick") && shown(".stills svg"));
    assert_eq!(browser.value("document.getElementById('views').hidden"), json!(true));
}

#[test]
fn the_page_of_a_campaign_is_quiet_and_says_its_verdict() {
    let Some(browser) = Browser::start() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("campaign");
    let campaign = project("tests/data/campaigns/hard-b7549");
    armwright(&["reconcile", campaign.to_str().expect("a path"), "--out", out.to_str().expect("a path")]);
    let page = out.join("report.html");
    browser.size(1280, 900);
    browser.open(&page);
    let verdict: Value =
        serde_json::from_str(&std::fs::read_to_string(out.join("verdict.json")).expect("the verdict"))
            .expect("JSON");
    let sentence = browser.text(".verdict");
    let expected = match verdict["verdict"].as_str().expect("a word") {
        "no_gap" => "no gap",
        "explained" => "explained by",
        "unexplained" => "no known effect",
        _ => "do not suffice",
    };
    assert!(sentence.contains(expected), "{sentence}");
    for part in
        verdict["located"]["parts"].as_array().expect("parts").iter().filter(|p| p["part"] == "static")
    {
        let before = significant(part["rms_sigma_before"].as_f64().expect("a number"), 3);
        assert!(browser.text("#fig-channels").contains(&before), "{before}");
    }
    quiet(&browser, &page);
    pictures(&browser, "campaign");
}

#[test]
fn the_page_of_a_comparison_overlays_the_fronts() {
    let Some(browser) = Browser::start() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let (results, out) = (bench_arm(folder.path()), folder.path().join("comparison"));
    armwright(&["compare", results.to_str().expect("a path"), "--out", out.to_str().expect("a path")]);
    let page = out.join("report.html");
    browser.size(1280, 900);
    browser.open(&page);
    assert_eq!(browser.count("document.querySelectorAll('#legend button').length"), 3);
    quiet(&browser, &page);
    pictures(&browser, "comparison");
}

/// A front of so many designs of a six-axis study with 1e8 designs.
fn large(front: usize) -> SummaryInput {
    let mut columns = vec!["design_id".to_string()];
    for link in ["upper_arm", "forearm", "hand"] {
        columns.extend(
            ["material", "shape", "width_mm", "height_mm", "wall_mm", "profile"]
                .map(|c| format!("{link}_{c}")),
        );
    }
    columns.extend((1..=6).flat_map(|j| ["gear", "motor"].map(|c| format!("j{j}_{c}"))));
    columns.extend(["tip_deflection_mm", "mass_kg", "lowest_mode_hz"].map(String::from));
    let materials = ["Structural steel S355", "Aluminium 6061-T6", "CFRP T300/5208", "Titanium Ti-6Al-4V"];
    let row = |i: usize, material: usize| {
        let x = (i as f64 + 0.37) / front as f64;
        let mut cells = vec![format!("{i:x}q")];
        for link in 0..3 {
            let size = (60 + 10 * ((i + link) % 12)).to_string();
            let shape = ["rectangular_tube", "round_tube"][i % 2];
            cells.extend(
                [materials[material], shape, &size, &size, ["2", "2.5", "3", "4"][(i / 7 + link) % 4], ""]
                    .map(String::from),
            );
        }
        for joint in 0..6 {
            cells.extend([
                format!("CSG-{}-{}", [14, 17, 25, 32, 40, 58][(i / 3 + joint) % 6], [50, 100][i % 2]),
                format!("ILM{}x18", 25 + (i + joint) % 40),
            ]);
        }
        cells.extend(
            [0.5 + 12.0 * (-4.0 * x).exp() + 0.01 * (material as f64), 6.0 + 70.0 * x, 2.0 + 20.0 * x.sqrt()]
                .map(|v| v.to_string()),
        );
        cells
    };
    let table = |rows: Vec<Vec<String>>| FrontTable { columns: columns.clone(), rows };
    let per_material = |m: usize| MaterialFront {
        ties_listed: true,
        status: "complete".into(),
        name: materials[m].into(),
        cost_eur_per_kg: None,
        front: table((0..front).filter(|i| i % 4 == m).map(|i| row(i, m)).collect()),
    };
    SummaryInput {
        facts: SummaryFacts {
            study: "large".into(),
            status: "complete".into(),
            designs_total: 100_000_000,
            ..SummaryFacts::default()
        },
        overall: table((0..front).map(|i| row(i, i % 4)).collect()),
        materials: (0..4).map(per_material).collect(),
        budgets: Vec::new(),
    }
}

/// A page with nothing but a front.
fn page_of(summary: &SummaryInput) -> String {
    let page = StudyPage {
        summary,
        picks: Vec::new(),
        scatter_svg: String::new(),
        beams: None,
        parts: Vec::new(),
        run: Vec::new(),
        timing: Vec::new(),
        extras: Vec::new(),
    };
    page.page().html
}

#[test]
fn a_front_of_ten_thousand_designs_is_on_the_page_whole() {
    let html = page_of(&large(10_000));
    assert!(html.len() < MOST_BYTES as usize / 2, "{} bytes: the rest of a page needs room too", html.len());
    let Some(browser) = Browser::start() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("report.html");
    std::fs::write(&file, html).expect("the page is written");
    browser.size(1280, 900);
    browser.open(&file);
    assert_eq!(browser.text("#count"), "10,000 of 10,000 designs selected");
    assert_eq!(browser.value("document.querySelector('.note')"), Value::Null, "nothing is left out");
    // what takes its time does not grow with the front: elements, and lines drawn
    assert!(browser.count("document.querySelectorAll('*').length") < 6_000);
    quiet(&browser, &file);
}

#[test]
fn a_front_of_a_hundred_thousand_designs_is_thinned_and_says_so() {
    let html = page_of(&large(100_000));
    assert!(html.len() < MOST_BYTES as usize, "{} bytes", html.len());
    let words = "of 100,000 designs of the front";
    assert!(html.contains(words), "the page does not say what it leaves out");
}
