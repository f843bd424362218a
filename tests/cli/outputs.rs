//! What is written where: nothing in place of what is read or of another output, nothing half, nothing lost for want of room.

use std::fs;

use crate::run::Workspace;
use photonvdb::film::read_rgb;

#[test]
fn outputs_take_neither_each_others_place_nor_that_of_what_is_read() {
    let work = Workspace::new();
    assert_eq!(work.run("render fog.toml -o truth.exr --photons 100").code, Some(0));
    let truth = fs::read(work.path("truth.exr")).unwrap();
    let scene = fs::read(work.path("fog.toml")).unwrap();
    for (flags, said) in [
        ("-o fog.exr --report fog.exr", "--report would be written in place of --output"),
        ("-o fog.exr --checkpoint ./fog.exr", "--checkpoint would be written in place of --output"),
        ("-o fog.exr --preview fog.png --report fog.png", "in place of --preview"),
        ("-o fog.exr --report fog.toml", "--report would be written in place of the scene"),
        ("-o truth.exr --reference truth.exr", "--output would be written in place of --reference"),
    ] {
        work.run(&format!("render fog.toml --photons 100 {flags}")).fails_with(said);
    }
    assert_eq!(work.names(), ["fog.toml", "truth.exr"]);
    assert_eq!(fs::read(work.path("truth.exr")).unwrap(), truth);
    assert_eq!(fs::read(work.path("fog.toml")).unwrap(), scene);
    // What is no file may be given as often as one likes.
    let run = work.run("render fog.toml -o /dev/null --report /dev/null --photons 100 --quiet");
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""));
}

#[test]
fn a_volume_is_not_baked_over() {
    let work = Workspace::new();
    let media = concat!(env!("CARGO_MANIFEST_DIR"), "/media/smoke_plume.vdb");
    fs::copy(media, work.path("plume.vdb")).unwrap();
    assert_eq!(work.run("new plume.toml --from plume.vdb").code, Some(0));
    let run = work.run("bake plume.toml -o ./plume.vdb --photons 100");
    run.fails_with("--output would be written in place of medium.file: both are ./plume.vdb");
    assert_eq!(fs::read(work.path("plume.vdb")).unwrap(), fs::read(media).unwrap());
}

#[test]
fn names_promise_what_comes() {
    let work = Workspace::new();
    work.run("render fog.toml -o fog.png").fails_with("--preview writes a .png");
    work.run("render fog.toml -o fog.toml").fails_with("its name must end in .exr\n");
    work.run("render fog.toml -o fog.exr --preview fog.jpg").fails_with("must end in .png");
    work.run("render smoke.vdb -o fog.exr").fails_with("photonvdb new SCENE.toml --from smoke.vdb");
}

#[cfg(unix)]
#[test]
fn names_need_not_be_unicode() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;

    let work = Workspace::new();
    let image = OsStr::from_bytes(b"fog \xff.exr");
    let run = work.command("render fog.toml --photons 100 -o").arg(image).output().unwrap();
    assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stderr));
    read_rgb(&work.path("").join(image)).unwrap();
}

/// `/dev/full` is a disk that is always full: the image goes among temporary files, and the rest where it was to go.
#[cfg(target_os = "linux")]
#[test]
fn an_image_without_room_is_kept_elsewhere() {
    let work = Workspace::new();
    fs::create_dir(work.path("spare")).unwrap();
    let mut command = work
        .command("render fog.toml -o /dev/full --photons 100 --preview fog.png --report fog.json");
    let run = command.env("TMPDIR", work.path("spare")).output().unwrap();
    assert_eq!(run.status.code(), Some(2));
    let said = String::from_utf8(run.stderr).unwrap();
    let (_, kept) = said.trim_end().split_once("; the image is kept in ").expect(&said);
    assert!(said.contains("error: cannot write /dev/full: No space left on device"), "{said}");
    assert_eq!(read_rgb(kept.as_ref()).unwrap().width, 24);
    assert_eq!(fs::read_dir(work.path("spare")).unwrap().count(), 1, "no half-written file");
    assert_eq!(work.names(), ["fog.json", "fog.png", "fog.toml", "spare"]);
}

/// A log on a full disk must not cost the image.
#[cfg(target_os = "linux")]
#[test]
fn a_stderr_without_room_ends_nothing() {
    let work = Workspace::new();
    for flags in ["--passes 2", "--show"] {
        let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let arguments = format!("render fog.toml -o fog.exr --photons 100 {flags}");
        let status = work.command(&arguments).stderr(full).status().unwrap();
        assert_eq!(status.code(), Some(0), "{flags}");
        read_rgb(&work.path("fog.exr")).unwrap();
    }
    let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let status = work.command("render none.toml -o fog.exr").stderr(full).status().unwrap();
    assert_eq!(status.code(), Some(2));
}
