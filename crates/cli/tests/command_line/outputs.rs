//! Where pictures go, and what happens where they cannot.

use crate::program::{names, program, render};
use std::path::Path;
use std::process::Command;

const TINY: &str = "--size 4x3 --spp 1";

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().unwrap()
}

#[test]
fn the_default_is_named_after_the_scene() {
    let folder = folder();
    render(folder.path(), TINY).succeeded().says(&["wrote cornell_ball.png"]);
    render(folder.path(), &format!("cornell_glass {TINY}")).succeeded();
    assert_eq!(names(folder.path()), ["cornell_ball.png", "cornell_glass.png"]);
}

#[test]
fn names_of_scenes_that_are_no_file_names() {
    let long = "very ".repeat(100);
    for (name, file) in [
        ("a/b\\c", "a_b_c.png"),
        ("..", "picture.png"),
        ("Šibenik ☀", "Šibenik _.png"),
        (&long, &*format!("{}.png", long[..60].trim())),
    ] {
        let scene = raystream_tests::scene_folder::SceneFolder::new()
            .json(|scene| scene["name"] = name.into());
        render(&scene.path(""), "scene.json --spp 1").succeeded();
        assert!(scene.path(file).is_file(), "{file} is not among {:?}", names(&scene.path("")));
    }
}

#[test]
fn several_outputs() {
    let folder = folder();
    render(folder.path(), &format!("{TINY} -o a.exr -o b.png --output c.EXR")).succeeded();
    assert_eq!(names(folder.path()), ["a.exr", "b.png", "c.EXR"]);
    render(folder.path(), &format!("{TINY} -o d.exr -o ./d.exr")).failed(&["d.exr", "twice"]);
    assert_eq!(names(folder.path()), ["a.exr", "b.png", "c.EXR"]);
}

#[cfg(unix)]
#[test]
fn links_lead_to_what_is_written() {
    use std::os::unix::fs::symlink;
    let folder = folder();
    std::fs::create_dir(folder.path().join("store")).unwrap();
    symlink("store/new.png", folder.path().join("link.png")).unwrap();
    render(folder.path(), &format!("{TINY} -o link.png -o store/new.png"))
        .failed(&["store/new.png", "twice"]);
    assert_eq!(names(&folder.path().join("store")), [""; 0]);
    render(folder.path(), &format!("{TINY} -o link.png")).succeeded();
    assert_eq!(names(&folder.path().join("store")), ["new.png"]);
    assert!(folder.path().join("link.png").symlink_metadata().unwrap().is_symlink());
    symlink("lost/new.png", folder.path().join("lost.png")).unwrap();
    refused_at_once(folder.path(), "lost.png", &["lost.png", "there is no folder", "lost"]);
}

#[test]
fn layers_as_pictures() {
    let folder = folder();
    let beside = |name: &str| {
        ["albedo", "depth", "error", "filtered", "normal", "samples"]
            .map(|layer| format!("{name}.{layer}.png"))
    };
    render(folder.path(), &format!("{TINY} --png-layers")).succeeded().says(&[
        "wrote cornell_ball.png\n",
        "wrote cornell_ball.samples.png\n",
        "wrote cornell_ball.depth.png\n",
    ]);
    let mut expected = vec!["cornell_ball.png".to_owned()];
    expected.extend(beside("cornell_ball"));
    expected.sort();
    assert_eq!(names(folder.path()), expected);

    let folder = self::folder();
    render(folder.path(), &format!("{TINY} --png-layers -q -o a.exr -o b.png -o c.d.PNG"))
        .succeeded();
    expected = ["a.exr", "b.png", "c.d.PNG"].map(str::to_owned).into();
    expected.extend(beside("b").into_iter().chain(beside("c.d")));
    expected.sort();
    assert_eq!(names(folder.path()), expected);
    // Every pixel of the uniform render has the same count, and the legend is wider than the
    // picture.
    let samples = raystream::image::read_color(&folder.path().join("b.samples.png")).unwrap();
    let first_row = &samples.pixels[..4];
    assert!(samples.width > 100 && first_row.iter().all(|color| *color == first_row[0]));
    assert_eq!(raystream::image::read_color(&folder.path().join("b.albedo.png")).unwrap().width, 4);
}

#[test]
fn layers_that_cannot_be_written() {
    let folder = folder();
    refused_at_once(folder.path(), "a.exr --png-layers", &["--png-layers", ".png"]);
    refused_at_once(
        folder.path(),
        "a.png -o a.depth.png --png-layers",
        &["a.depth.png", "written twice"],
    );
    refused_at_once(folder.path(), "a.png -o a.PNG --png-layers", &["a.", "twice"]);
    std::fs::create_dir(folder.path().join("a.normal.png")).unwrap();
    refused_at_once(folder.path(), "a.png --png-layers", &["a.normal.png", "name a file"]);
}

#[test]
fn paths_in_any_script() {
    let folder = folder();
    let path = folder.path().join("ordner ☀ 日本");
    std::fs::create_dir(&path).unwrap();
    let arguments =
        ["render", "--device", "cpu", "--size", "4x3", "--spp", "1", "-o", "bild – é.exr"];
    assert!(program(&path, &arguments).output().unwrap().status.success());
    assert_eq!(names(&path), ["bild – é.exr"]);
}

/// Fails before anything is rendered: with this many samples, a render would take far longer than
/// the tests.
#[track_caller]
fn refused_at_once(folder: &Path, output: &str, parts: &[&str]) {
    let before = names(folder);
    render(folder, &format!("--size 1000x1000 --spp 1000000 -o good.exr -o {output}"))
        .failed(parts);
    assert_eq!(names(folder), before);
}

#[test]
fn paths_that_cannot_be_written() {
    let folder = folder();
    std::fs::create_dir(folder.path().join("folder.exr")).unwrap();
    refused_at_once(folder.path(), "missing/a.exr", &["missing/a.exr", "create it"]);
    refused_at_once(folder.path(), "folder.exr", &["folder.exr", "name a file"]);
    refused_at_once(folder.path(), "a.jpg", &["a.jpg", ".exr or .png"]);
    refused_at_once(folder.path(), "a", &["a:", ".exr or .png"]);
}

#[cfg(unix)]
#[test]
fn a_folder_that_is_read_only() {
    use std::os::unix::fs::PermissionsExt;
    let folder = folder();
    let locked = folder.path().join("locked");
    std::fs::create_dir(&locked).unwrap();
    std::fs::set_permissions(&locked, std::fs::Permissions::from_mode(0o555)).unwrap();
    if tempfile::tempfile_in(&locked).is_ok() {
        eprintln!(
            "NOT TESTED with a read-only folder of one's own: this user (root) may write everywhere"
        );
    } else {
        refused_at_once(folder.path(), "locked/a.exr", &["locked/a.exr"]);
    }
    std::fs::set_permissions(&locked, std::fs::Permissions::from_mode(0o755)).unwrap();
    // Not even root can create a file here.
    #[cfg(target_os = "linux")]
    refused_at_once(folder.path(), "/proc/a.exr", &["/proc/a.exr"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk() {
    struct Mounted(tempfile::TempDir);
    impl Drop for Mounted {
        fn drop(&mut self) {
            let _ = Command::new("umount").arg(self.0.path()).status();
        }
    }
    let disk = folder();
    let mount = Command::new("mount")
        .args(["-t", "tmpfs", "-o", "size=64k", "tmpfs"])
        .arg(disk.path())
        .output();
    if !mount.is_ok_and(|output| output.status.success()) {
        eprintln!(
            "NOT TESTED: a full disk needs the right to mount a tmpfs; run the tests as root"
        );
        return;
    }
    let disk = Mounted(disk);
    let elsewhere = folder();
    let full = disk.0.path().join("a.exr");
    std::fs::write(&full, b"old").unwrap();
    let arguments = format!("--size 100x100 --spp 1 -o {} -o b.exr", full.display());
    render(elsewhere.path(), &arguments).failed(&[
        full.to_str().unwrap(),
        "no space left",
        "wrote b.exr",
    ]);
    assert_eq!(std::fs::read(&full).unwrap(), b"old");
    assert_eq!(names(disk.0.path()), ["a.exr"]);
    assert_eq!(names(elsewhere.path()), ["b.exr"], "the other picture saves the render");
}
