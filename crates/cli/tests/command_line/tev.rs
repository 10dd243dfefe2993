//! `render --tev`: what a listener in place of tev is sent.

use crate::program::{program, render, run};
use glam::Vec3;
use std::io::Read;
use std::net::TcpListener;

/// The packets of a connection: of each its kind and what it says.
fn packets(stream: &mut impl Read) -> Vec<(u8, Vec<u8>)> {
    let mut sent = Vec::new();
    stream.read_to_end(&mut sent).unwrap();
    let (mut packets, mut rest) = (Vec::new(), sent.as_slice());
    while !rest.is_empty() {
        // The length counts itself.
        let (length, _) = rest.split_first_chunk().unwrap();
        let (packet, others) = rest.split_at(u32::from_le_bytes(*length) as usize);
        packets.push((packet[4], packet[5..].to_vec()));
        rest = others;
    }
    packets
}

#[test]
fn pictures_are_sent_to_tev_and_the_last_one_is_that_of_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap().to_string();
    let tev = std::thread::spawn(move || packets(&mut listener.accept().unwrap().0));
    let arguments = format!("--size 8x6 --spp 9 -o a.exr --tev {address} -q");
    assert_eq!(render(folder.path(), &arguments).succeeded().stderr, "");
    let packets = tev.join().unwrap();
    let (kind, created) = &packets[0];
    assert_eq!(*kind, 4, "an image is created");
    // The focus is grabbed; the name; width, height and the number of channels.
    let start = [b"\x01cornell_ball\0".as_slice(), &[8, 0, 0, 0, 6, 0, 0, 0, 4, 0, 0, 0]].concat();
    assert!(created.starts_with(&start), "{created:?}");
    assert!(packets.len() >= 2 && packets[1..].iter().all(|(kind, _)| *kind == 6), "updates");
    let (_, last) = packets.last().unwrap();
    let sent: Vec<f32> = last[last.len() - 8 * 6 * 16..]
        .chunks_exact(4)
        .map(|bytes| f32::from_le_bytes(bytes.try_into().unwrap()))
        .collect();
    let image = raystream::image::read_color(&folder.path().join("a.exr")).unwrap();
    let written: Vec<f32> = image.pixels.iter().flat_map(Vec3::to_array).collect();
    let colors: Vec<f32> = sent.chunks_exact(4).flat_map(|pixel| pixel[..3].to_vec()).collect();
    assert_eq!(colors, written);
    let samples: f32 = sent.chunks_exact(4).map(|pixel| pixel[3]).sum();
    assert_eq!(samples, 9.0 * 48.0);
}

#[test]
fn without_tev_nothing_is_rendered() {
    let folder = tempfile::tempdir().unwrap();
    // A port that was free a moment ago.
    let address = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().to_string();
    let told = render(folder.path(), &format!("--size 8x6 --tev {address} -o a.png"));
    told.failed(&["tev does not listen at", &address, "start it first"]);
    assert!(!folder.path().join("a.png").exists());
    for wrong in ["nonsense", "localhost:0", "localhost:99999"] {
        run(folder.path(), &format!("render --tev {wrong}"))
            .failed(&[wrong, "a host and a port, such as 127.0.0.1:14158"]);
    }
}

#[test]
fn tev_that_leaves_is_a_warning_and_the_picture_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap().to_string();
    let tev = std::thread::spawn(move || drop(listener.accept().unwrap()));
    let arguments = format!("render --device cpu --size 256x256 --time 1 -o a.png --tev {address}");
    let arguments: Vec<_> = arguments.split(' ').collect();
    let output = program(folder.path(), &arguments).output().unwrap();
    tev.join().unwrap();
    crate::program::Run::new(output).succeeded().says(&["warning: tev no longer listens"]);
    assert!(folder.path().join("a.png").exists());
}
