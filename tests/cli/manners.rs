//! Help, manual pages, completions, schema, presets, and the picture in the terminal.

use std::fs;

use crate::run::Workspace;
use serde_json::Value;

/// The commands that the help lists.
fn commands(work: &Workspace) -> Vec<String> {
    let help = work.run("--help").stdout;
    let (_, list) = help.split_once("Commands:\n").unwrap();
    let lines = list.lines().take_while(|line| !line.is_empty());
    let starts = lines.filter(|line| line.starts_with("  ") && !line.starts_with("   "));
    let names = starts.filter_map(|line| line.split_whitespace().next());
    names.filter(|name| *name != "help").map(Into::into).collect()
}

#[test]
fn every_help_has_examples() {
    let work = Workspace::new();
    let commands = commands(&work);
    assert!(commands.len() >= 13, "{commands:?}");
    for command in [""].into_iter().chain(commands.iter().map(String::as_str)) {
        for flag in ["--help", "-h"] {
            let run = work.run(&format!("{command} {flag}"));
            assert_eq!(run.code, Some(0));
            let (_, examples) = run.stdout.split_once("Examples:\n").expect(command);
            assert!(examples.starts_with("  photonvdb "), "{command}");
        }
    }
}

#[test]
fn every_command_has_a_manual_page() {
    let work = Workspace::new();
    let page = work.run("man");
    assert_eq!(page.code, Some(0));
    assert!(
        page.stdout.contains(".SH EXAMPLES\n.nf\n") && page.stdout.contains("photonvdb\\-render")
    );
    assert_eq!(work.run("man pages/man1").code, Some(0));
    for command in commands(&work) {
        let page =
            fs::read_to_string(work.path(&format!("pages/man1/photonvdb-{command}.1"))).unwrap();
        assert!(page.contains(&format!(".TH photonvdb-{command} 1")), "{command}");
        assert!(page.contains(".SH EXAMPLES\n"), "{command}");
    }
    assert_eq!(fs::read_to_string(work.path("pages/man1/photonvdb.1")).unwrap(), page.stdout);
}

#[test]
fn every_shell_can_complete() {
    let work = Workspace::new();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let run = work.run(&format!("completions {shell}"));
        assert_eq!(run.code, Some(0), "{}", run.stderr);
        for word in ["photonvdb", "convert", "target-error", "optical-depth"] {
            assert!(run.stdout.contains(word), "{shell}: {word}");
        }
    }
    work.run("completions tcsh").fails_with("possible values: bash, elvish, fish, powershell, zsh");
}

#[test]
fn schema_and_presets_are_printed() {
    let work = Workspace::new();
    let schema: Value = serde_json::from_str(&work.run("schema").stdout).unwrap();
    assert_eq!(schema, photonvdb::scene::json_schema());
    assert_eq!(work.run("schema --markdown").stdout, photonvdb::scene::scene_reference());
    let list = work.run("presets").stdout;
    assert!(list.contains("fog ") && list.contains("sigma_t = 0.01956"), "{list}");
    assert!(work.run("presets fog").stdout.contains("Koschmieder"));
    work.run("presets milk").fails_with("whole-milk");
}

#[test]
fn the_picture_is_shown_only_when_asked_for_and_on_stderr() {
    let work = Workspace::new();
    let block = '\u{2580}';
    let plain = work.run("render fog.toml -o fog.exr --quiet");
    assert!(!plain.stderr.contains(block));
    let run = |color: &str| {
        let mut command = work.command("render fog.toml -o fog.exr --quiet --show --report -");
        let output = command.env("COLORTERM", color).output().unwrap();
        assert_eq!(output.status.code(), Some(0));
        let _: Value = serde_json::from_slice(&output.stdout).unwrap();
        String::from_utf8(output.stderr).unwrap()
    };
    let (direct, indexed) = (run("truecolor"), run(""));
    // 24 x 16 pixels, two rows a line.
    for picture in [&direct, &indexed] {
        assert_eq!(picture.lines().count(), 8);
        assert_eq!(picture.matches(block).count(), 24 * 8);
    }
    assert!(direct.contains("\x1b[38;2;") && indexed.contains("\x1b[38;5;"));
}
