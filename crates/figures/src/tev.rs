//! Pictures for [tev](https://github.com/Tom94/tev), a viewer that listens on the network.

use raystream::film::Film;
use std::io;
use std::net::{TcpStream, ToSocketAddrs};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;
use tev_client::{PacketCreateImage, PacketUpdateImage, TevClient};

/// Where tev listens unless it was told otherwise.
pub const DEFAULT_ADDRESS: &str = "127.0.0.1:14158";
/// So long an address may take to answer.
const PATIENCE: Duration = Duration::from_secs(2);
/// The channels that are sent.
const CHANNELS: [&str; 4] = ["R", "G", "B", "samples.N"];

/// Nobody listens where tev was looked for.
#[derive(Debug, thiserror::Error)]
#[error("tev does not listen at {address}: {source}; start it first, or name where it listens")]
pub struct TevError {
    address: String,
    source: io::Error,
}

/// An address as an option's value: a host and a port.
///
/// # Errors
/// What is wrong with it.
pub fn parse_address(text: &str) -> Result<String, String> {
    let port = text.rsplit_once(':').filter(|(host, _)| !host.is_empty());
    match port.map(|(_, port)| port.parse::<u16>()) {
        Some(Ok(1..)) => Ok(text.to_owned()),
        _ => Err(format!("give a host and a port, such as {DEFAULT_ADDRESS}")),
    }
}

/// A connection to tev. It sends in a thread of its own, and leaves out pictures that have been
/// replaced before it was their turn.
pub struct Tev {
    post: Arc<Post>,
    thread: Option<JoinHandle<()>>,
}

#[derive(Default)]
struct Post {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Default)]
struct State {
    film: Option<Arc<Film>>,
    is_closing: bool,
    failure: Option<String>,
}

impl Post {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The next picture; None when there will be none.
    fn next(&self) -> Option<Arc<Film>> {
        let mut state = self.state();
        while state.film.is_none() && !state.is_closing {
            state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
        state.film.take()
    }
}

impl Tev {
    /// Connects to `address`, a host and a port; pictures are called `name` there.
    ///
    /// # Errors
    /// If nobody listens there.
    pub fn connect(address: &str, name: &str) -> Result<Self, TevError> {
        let connected = Self::connect_to(address, name);
        connected.map_err(|source| TevError { address: address.to_owned(), source })
    }

    fn connect_to(address: &str, name: &str) -> io::Result<Self> {
        let none = || io::Error::new(io::ErrorKind::NotFound, "there is no such address");
        let address = address.to_socket_addrs()?.next().ok_or_else(none)?;
        let stream = TcpStream::connect_timeout(&address, PATIENCE)?;
        stream.set_write_timeout(Some(Duration::from_secs(10)))?;
        let post = Arc::new(Post::default());
        let (kept, name) = (Arc::clone(&post), name.to_owned());
        let thread = std::thread::Builder::new().name("tev".to_owned()).spawn(move || {
            let mut client = TevClient::wrap(stream);
            let mut size = None;
            while let Some(film) = post.next() {
                if let Err(error) = send(&mut client, &name, &film, &mut size) {
                    post.state().failure = Some(format!("tev no longer listens: {error}"));
                    return;
                }
            }
        })?;
        Ok(Self { post: kept, thread: Some(thread) })
    }

    /// Shows a picture.
    pub fn show(&self, film: Arc<Film>) {
        self.post.state().film = Some(film);
        self.post.changed.notify_all();
    }

    /// What has gone wrong, once.
    pub fn take_failure(&self) -> Option<String> {
        self.post.state().failure.take()
    }

    /// Waits until the last picture has been sent, and ends. Returns what has gone wrong.
    pub fn finish(mut self) -> Option<String> {
        self.close();
        // It does not panic.
        let _ = self.thread.take().map(JoinHandle::join);
        self.take_failure()
    }

    fn close(&self) {
        self.post.state().is_closing = true;
        self.post.changed.notify_all();
    }
}

impl Drop for Tev {
    fn drop(&mut self) {
        self.close();
    }
}

/// Sends a picture; `size` is that of the last one.
fn send(
    client: &mut TevClient,
    name: &str,
    film: &Film,
    size: &mut Option<(u32, u32)>,
) -> io::Result<()> {
    let (width, height) = (film.width, film.height);
    if *size != Some((width, height)) {
        client.send(PacketCreateImage {
            image_name: name,
            grab_focus: true,
            width,
            height,
            channel_names: &CHANNELS,
        })?;
        *size = Some((width, height));
    }
    let colors = film.best();
    let pixels = colors.iter().zip(film.samples());
    let data: Vec<f32> =
        pixels.flat_map(|(color, n)| [color.x, color.y, color.z, n as f32]).collect();
    client.send(PacketUpdateImage {
        image_name: name,
        grab_focus: false,
        channel_names: &CHANNELS,
        channel_offsets: &[0, 1, 2, 3],
        channel_strides: &[4; 4],
        x: 0,
        y: 0,
        width,
        height,
        data: &data,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use raystream_shaders::film::FilmPixel;
    use std::io::Read;
    use std::net::TcpListener;

    /// The next packet: its kind and what it says.
    fn packet(stream: &mut TcpStream) -> (u8, Vec<u8>) {
        let mut length = [0; 4];
        stream.read_exact(&mut length).unwrap();
        // The length counts itself.
        let mut bytes = vec![0; u32::from_le_bytes(length) as usize - 4];
        stream.read_exact(&mut bytes).unwrap();
        (bytes[0], bytes[1..].to_vec())
    }

    fn words(bytes: &[u8]) -> Vec<u32> {
        bytes.chunks_exact(4).map(|word| u32::from_le_bytes(word.try_into().unwrap())).collect()
    }

    fn film(samples: u32) -> Arc<Film> {
        let pixel = FilmPixel {
            first_sum: glam::Vec3::new(0.5, 1.0, 1.5) * samples as f32,
            first_samples: samples,
            ..FilmPixel::default()
        };
        Arc::new(Film::new(2, 1, vec![pixel; 2], vec![Default::default(); 2]))
    }

    #[test]
    fn pictures_arrive_as_tev_reads_them() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap().to_string();
        let tev = Tev::connect(&address, "a scene").unwrap();
        let (mut stream, _) = listener.accept().unwrap();
        tev.show(film(4));
        let (kind, bytes) = packet(&mut stream);
        assert_eq!(kind, 4, "an image is created");
        // Whether it grabs the focus, its name, and then its size and channels.
        let text = b"\x01a scene\0";
        assert_eq!(&bytes[..text.len()], text);
        assert_eq!(words(&bytes[text.len()..text.len() + 12]), [2, 1, 4]);
        assert!(bytes.ends_with(b"R\0G\0B\0samples.N\0"));
        for samples in [4, 8] {
            if samples == 8 {
                tev.show(film(8));
            }
            let (kind, bytes) = packet(&mut stream);
            assert_eq!(kind, 6, "it is updated");
            let numbers: Vec<f32> =
                words(&bytes[bytes.len() - 32..]).into_iter().map(f32::from_bits).collect();
            let pixel = [0.5, 1.0, 1.5, samples as f32];
            assert_eq!(numbers, [pixel, pixel].concat());
        }
        drop(tev);
        assert_eq!(stream.read(&mut [0]).unwrap(), 0, "the connection ends");
    }

    #[test]
    fn nobody_who_listens_is_an_error_and_one_who_leaves_a_message() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap().to_string();
        let tev = Tev::connect(&address, "a").unwrap();
        drop(listener.accept().unwrap());
        drop(listener);
        let failure = (0..1000).find_map(|_| {
            tev.show(film(1));
            std::thread::sleep(Duration::from_millis(5));
            tev.take_failure()
        });
        assert!(failure.unwrap().contains("tev"));
        for address in [address.as_str(), "no host at all"] {
            let error = Tev::connect(address, "a").err().unwrap().to_string();
            assert!(error.contains(address) && error.contains("start it first"), "{error}");
        }
    }

    #[test]
    fn the_last_picture_is_sent_before_the_end() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let tev = Tev::connect(&listener.local_addr().unwrap().to_string(), "a").unwrap();
        let (mut stream, _) = listener.accept().unwrap();
        tev.show(film(4));
        assert_eq!(tev.finish(), None);
        let kinds = [packet(&mut stream).0, packet(&mut stream).0];
        assert_eq!(kinds, [4, 6]);
        assert_eq!(stream.read(&mut [0]).unwrap(), 0, "the connection ends");
    }

    #[test]
    fn addresses_are_a_host_and_a_port() {
        for right in [DEFAULT_ADDRESS, "localhost:1", "[::1]:14158", "a.b:65535"] {
            assert_eq!(parse_address(right).as_deref(), Ok(right));
        }
        for wrong in ["", "14158", "localhost", ":14158", "localhost:0", "a:65536", "scene.json"] {
            let message = parse_address(wrong).unwrap_err();
            assert!(message.contains(DEFAULT_ADDRESS), "{wrong}: {message}");
        }
    }
}
