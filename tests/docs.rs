//! The pages: what they link to is there, every picture is in the gallery, and every command can be typed.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

const PAGES: [&str; 10] = [
    "README.md",
    "ARCHITECTURE.md",
    "CONTRIBUTING.md",
    "docs/GUIDE.md",
    "docs/SCENE.md",
    "docs/GALLERY.md",
    "docs/GOLDENS.md",
    "media/README.md",
    "src/estimate/README.md",
    "src/estimate/MEASURED.md",
];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn read(page: &str) -> String {
    fs::read_to_string(root().join(page)).unwrap()
}

/// What stands between `start` and `end`, each time.
fn between<'a>(text: &'a str, start: &'a str, end: char) -> impl Iterator<Item = &'a str> {
    text.split(start).skip(1).filter_map(move |rest| rest.split_once(end)).map(|(inner, _)| inner)
}

#[test]
fn links_lead_somewhere() {
    let mut count = 0;
    for page in PAGES {
        let text = read(page);
        let folder = root().join(page).parent().unwrap().to_path_buf();
        let links = between(&text, "](", ')').chain(between(&text, "src=\"", '"'));
        for link in links.filter(|link| !link.contains("://") && !link.starts_with('#')) {
            let file = link.split('#').next().unwrap();
            assert!(folder.join(file).exists(), "{page}: {link}");
            count += 1;
        }
    }
    assert!(count > 60, "{count}");
}

#[test]
fn every_picture_is_in_the_gallery() {
    let gallery = read("docs/GALLERY.md");
    for entry in fs::read_dir(root().join("docs")).unwrap() {
        let path: PathBuf = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap();
        if name.ends_with(".png") || name.ends_with(".svg") {
            assert!(gallery.contains(&format!("src=\"{name}\"")), "{name}");
        }
    }
}

#[test]
fn examples_are_numbered_and_named_in_order() {
    let entries = fs::read_dir(root().join("examples")).unwrap();
    let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<_> =
        names.filter_map(|name| name.strip_suffix(".rs").map(str::to_owned)).collect();
    names.sort();
    let readme = read("README.md");
    let listed: Vec<_> = between(&readme, "--release --example ", ' ').collect();
    assert_eq!(listed, names);
    for (index, name) in names.iter().enumerate() {
        assert!(name.starts_with(&format!("{:02}_", index + 1)), "{name}");
    }
}

/// Each is parsed by the program itself, which then shows its help instead of running it.
#[test]
fn commands_can_be_typed() {
    let program = env!("CARGO_BIN_EXE_photonvdb");
    let help = |command: &[&str]| {
        let output = Command::new(program).args(command).arg("--help").output().unwrap();
        (output.status.code(), String::from_utf8(output.stdout).unwrap(), output.stderr)
    };
    let blocks = |page: &str| -> String {
        let text = read(page);
        let parts = text.split("```").enumerate().filter(|(index, _)| index % 2 == 1);
        parts.map(|(_, block)| block.to_owned()).collect()
    };
    let mut lines: Vec<String> = PAGES.iter().flat_map(|page| commands(&blocks(page))).collect();
    let commands_of_help = commands(&help(&[]).1);
    for command in commands_of_help.iter().filter_map(|line| line.split(' ').nth(1)) {
        lines.extend(commands(&help(&[command]).1));
    }
    lines.extend(commands_of_help);
    assert!(lines.len() > 70, "{}", lines.len());
    for line in lines {
        let words: Vec<&str> = line.split_whitespace().skip(1).collect();
        let (code, _, error) = help(&words);
        assert_eq!(code, Some(0), "{line}: {}", String::from_utf8_lossy(&error));
    }
}

/// Lines that are a command, without comments and what is done with the output.
fn commands(text: &str) -> Vec<String> {
    let lines = text.lines().map(str::trim).filter(|line| line.starts_with("photonvdb "));
    let ends = [" | ", " > ", " >> ", " # "];
    let command = |line: &str| {
        ends.iter().fold(line.to_owned(), |line, end| {
            line.split(end).next().unwrap_or_default().trim_end().to_owned()
        })
    };
    lines.map(command).collect()
}
