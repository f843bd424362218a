//! Runs the binary in a directory of its own that holds one small scene, `fog.toml`.
#![allow(dead_code)]

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use tempfile::TempDir;

const FOG: &str = r#"
[camera]
position = [2.2, 1.8, 4.2]
look_at = [0.0, 0.0, 0.0]
vertical_fov = 38.0
resolution = [24, 16]

[medium]
kind = "homogeneous"
bounds = { min = [-1.0, -1.0, -1.0], max = [1.0, 1.0, 1.0] }
sigma_t = 1.0
albedo = 0.9

[[light]]
kind = "point"
position = [0.3, 0.4, 0.2]
intensity = 1.0

[photons]
count = 2000
"#;

/// A directory with `fog.toml`, removed in the end.
pub struct Workspace {
    directory: TempDir,
}

/// What a run left behind.
pub struct Run {
    pub code: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

impl Workspace {
    pub fn new() -> Self {
        let directory = tempfile::tempdir().unwrap();
        fs::write(directory.path().join("fog.toml"), FOG).unwrap();
        Self { directory }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.directory.path().join(name)
    }

    /// The files there, sorted.
    pub fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.directory.path()).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    /// `photonvdb` with arguments separated by spaces.
    pub fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_photonvdb"));
        command.args(arguments.split_whitespace()).current_dir(self.directory.path());
        command
    }

    /// Runs `photonvdb` with arguments separated by spaces.
    pub fn run(&self, arguments: &str) -> Run {
        let output = self.command(arguments).output().unwrap();
        Run {
            code: output.status.code(),
            stdout: String::from_utf8(output.stdout).unwrap(),
            stderr: String::from_utf8(output.stderr).unwrap(),
        }
    }
}

impl Run {
    /// Bad input: exit code 2, nothing on stdout, and an error that says `said`.
    pub fn fails_with(&self, said: &str) {
        assert_eq!(self.code, Some(2), "{}", self.stderr);
        assert_eq!(self.stdout, "");
        assert!(self.stderr.starts_with("error: "), "{}", self.stderr);
        assert!(self.stderr.contains(said), "{said} is not in\n{}", self.stderr);
    }
}
