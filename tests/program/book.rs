//! The documents as a book: every relative link and anchor must lead to an existing place, and the table of contents
//! must list every page.

use crate::words::files;
use armwright::arm::effect::KINDS;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

fn project() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn text(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// Every page of the project.
fn pages() -> Vec<PathBuf> {
    let mut out: Vec<PathBuf> = ["README.md", "CONTRIBUTING.md", "catalogs/README.md", "results/README.md"]
        .map(|name| project().join(name))
        .into();
    files(&project().join("docs"), "md", &mut out);
    out
}

/// A page without its fenced blocks.
fn without_fences(page: &str) -> String {
    let mut fenced = false;
    let outside = |line: &&str| {
        let fence = line.trim_start().starts_with("```");
        fenced ^= fence;
        !fenced && !fence
    };
    page.lines().filter(outside).collect::<Vec<_>>().join("\n")
}

/// The targets of a page's links; those inside code are none.
fn links(page: &str) -> Vec<String> {
    let page = without_fences(page);
    let ends = page.match_indices("](").map(|(at, _)| &page[at + 2..]);
    ends.filter_map(|rest| Some(rest[..rest.find(')')?].to_string())).collect()
}

/// The anchors of a page, as GitHub and mdBook make them from headings: a second heading of one name gets `-1`.
fn anchors(page: &str) -> BTreeSet<String> {
    let mut seen: BTreeMap<String, usize> = BTreeMap::new();
    let page = without_fences(page);
    let headings =
        page.lines().filter(|line| line.starts_with('#')).map(|line| line.trim_start_matches('#').trim());
    let anchor = |heading: &str| -> String {
        let kept = heading.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
        kept.map(|c| if c == ' ' { '-' } else { c.to_ascii_lowercase() }).collect()
    };
    let mut out = BTreeSet::new();
    for name in headings.map(anchor) {
        let count = seen.entry(name.clone()).and_modify(|n| *n += 1).or_default();
        out.insert(if *count == 0 { name } else { format!("{name}-{count}") });
    }
    out
}

#[test]
fn every_link_of_every_page_leads_to_a_file_and_a_heading() {
    let mut broken = Vec::new();
    let mut count = 0;
    for page in pages() {
        let folder = page.parent().expect("a folder");
        for link in links(&text(&page)).into_iter().filter(|link| !link.contains("://")) {
            let (file, anchor) = link.split_once('#').unwrap_or((&link, ""));
            let target = if file.is_empty() { page.clone() } else { folder.join(file) };
            let is_page = target.extension().is_some_and(|e| e == "md") && target.is_file();
            let leads =
                target.exists() && (anchor.is_empty() || is_page && anchors(&text(&target)).contains(anchor));
            if !leads {
                broken.push(format!("{}: {link}", page.strip_prefix(project()).expect("inside").display()));
            }
            count += 1;
        }
    }
    assert!(broken.is_empty(), "links that lead nowhere:\n{}", broken.join("\n"));
    assert!(count > 200, "only {count} links were found");
}

#[test]
fn a_link_to_no_heading_is_found() {
    let page = "# The `chain`: links\n\n## A\n\n## A\n\n```text\n# no heading\n[x](no-link)\n```\n[b](c.md#d) and ![e](f.png)";
    assert_eq!(anchors(page), ["a", "a-1", "the-chain-links"].map(String::from).into());
    assert_eq!(links(page), ["c.md#d", "f.png"]);
}

#[test]
fn the_table_of_contents_has_every_page_once() {
    let docs = project().join("docs");
    let mut listed = links(&text(&docs.join("SUMMARY.md")));
    listed.sort();
    let mut there = Vec::new();
    files(&docs, "md", &mut there);
    let name = |path: &PathBuf| path.strip_prefix(&docs).expect("inside").to_string_lossy().into_owned();
    let mut there: Vec<String> = there.iter().map(name).filter(|name| name != "SUMMARY.md").collect();
    there.sort();
    assert_eq!(listed, there, "docs/SUMMARY.md lists every page of docs once");
}

#[test]
fn the_page_of_effects_has_every_effect_with_what_it_is() {
    let page = text(&project().join("docs/effects/README.md"));
    for kind in KINDS {
        let start = format!("| [{0}]({0}.md) |", kind.name);
        let row = page.lines().find(|line| line.starts_with(&start));
        assert!(
            row.is_some_and(|row| row.ends_with(&format!("| {} |", kind.summary))),
            "{}: {row:?}",
            kind.name
        );
    }
}
