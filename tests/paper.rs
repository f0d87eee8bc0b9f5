//! explore
mod paper_support;
#[test]
fn write() {
    let c = paper_support::catalogs();
    for name in armwright::study::paper::NAMES {
        let out = armwright::study::paper::run(name, &c).unwrap();
        let dir = format!("/tmp/paperout/{name}");
        std::fs::create_dir_all(&dir).unwrap();
        for (f, b) in &out.files { std::fs::write(format!("{dir}/{f}"), b).unwrap(); }
        println!("{}", out.terminal);
    }
}
