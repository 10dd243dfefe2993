//! A web server for one folder and one machine: it answers GET and HEAD, and nothing from outside.

use anyhow::{Context, Result, ensure};
use std::fs;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

/// Bytes of a request's head at most.
const LONGEST_HEAD: u64 = 16 << 10;
/// So long a browser may say nothing on an open connection.
const PATIENCE: Duration = Duration::from_secs(30);

/// Serves the files of `folder` until the program ends.
///
/// # Errors
/// If there is no page in the folder, or another program has the port.
pub fn serve(folder: &Path, port: u16) -> Result<()> {
    let index = folder.join("index.html");
    ensure!(index.is_file(), "there is no {}; leave out --no-build", index.display());
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))
        .with_context(|| format!("cannot serve at port {port}; name another one by --port"))?;
    let address = listener.local_addr().context("the server has no address")?;
    println!("http://{address}/");
    io::stdout().flush().context("cannot say the address")?;
    listen(&listener, &Arc::from(folder));
    Ok(())
}

fn listen(listener: &TcpListener, folder: &Arc<Path>) {
    for stream in listener.incoming().flatten() {
        let folder = Arc::clone(folder);
        // A browser that goes away is no failure of the server's.
        std::thread::spawn(move || answer(&stream, &folder).ok());
    }
}

/// Answers the one request of a connection.
fn answer(stream: &TcpStream, folder: &Path) -> io::Result<()> {
    stream.set_read_timeout(Some(PATIENCE))?;
    let mut lines = BufReader::new(stream.take(LONGEST_HEAD)).lines();
    let request = lines.next().transpose()?.unwrap_or_default();
    while lines.next().transpose()?.is_some_and(|line| !line.is_empty()) {}
    let (status, kind, body) = respond(&request, folder);
    let mut stream = stream;
    write!(
        stream,
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {}\r\n\
         Cache-Control: no-cache\r\nX-Content-Type-Options: nosniff\r\nConnection: close\r\n\r\n",
        body.len()
    )?;
    if !request.starts_with("HEAD ") {
        stream.write_all(&body)?;
    }
    stream.flush()
}

/// Status, type and body of the answer to a request's first line.
fn respond(request: &str, folder: &Path) -> (&'static str, &'static str, Vec<u8>) {
    let text = "text/plain; charset=utf-8";
    let mut words = request.split(' ');
    if !matches!(words.next(), Some("GET" | "HEAD")) {
        return ("405 Method Not Allowed", text, b"only GET and HEAD\n".to_vec());
    }
    let found = words.next().and_then(|target| file(target, folder));
    match found.and_then(|path| Some((kind(&path), fs::read(path).ok()?))) {
        Some((kind, body)) => ("200 OK", kind, body),
        None => ("404 Not Found", text, b"there is no such file\n".to_vec()),
    }
}

/// The file that a request is for; None for one outside of the folder.
fn file(target: &str, folder: &Path) -> Option<PathBuf> {
    let path = target.split(['?', '#']).next()?.strip_prefix('/')?;
    let path = Path::new(if path.is_empty() { "index.html" } else { path });
    let is_inside = path.components().all(|part| matches!(part, Component::Normal(_)));
    is_inside.then(|| folder.join(path))
}

fn kind(path: &Path) -> &'static str {
    match path.extension().and_then(|ending| ending.to_str()) {
        Some("html") => "text/html; charset=utf-8",
        Some("css") => "text/css; charset=utf-8",
        Some("js") => "text/javascript; charset=utf-8",
        Some("json") => "application/json",
        Some("gz") => "application/gzip",
        _ => "application/octet-stream",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn site() -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("index.html"), "<p>it</p>").unwrap();
        fs::write(folder.path().join("a.gz"), "asm").unwrap();
        folder
    }

    #[test]
    fn files_have_their_types() {
        let site = site();
        let get = |target: &str| respond(&format!("GET {target} HTTP/1.1"), site.path());
        assert_eq!(get("/").0, "200 OK");
        assert_eq!(get("/?x=1"), get("/index.html"));
        assert_eq!(get("/a.gz"), ("200 OK", "application/gzip", b"asm".to_vec()));
    }

    #[test]
    fn nothing_outside_of_the_folder_is_served() {
        let site = site();
        let folder = site.path().join("inner");
        fs::create_dir(&folder).unwrap();
        let inside = folder.join("index.html");
        fs::write(&inside, "in").unwrap();
        for target in ["/../a.gz", "/x/../../a.gz", "//etc/passwd", "a.gz", "", "/no"] {
            let (status, ..) = respond(&format!("GET {target} HTTP/1.1"), &folder);
            assert_eq!(status, "404 Not Found", "{target}");
        }
        for request in ["POST / HTTP/1.1", "", "\0"] {
            assert_eq!(respond(request, &folder).0, "405 Method Not Allowed", "{request}");
        }
    }

    #[test]
    fn a_browser_gets_a_whole_answer() {
        let site = site();
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        let address = listener.local_addr().unwrap();
        let folder: Arc<Path> = Arc::from(site.path());
        std::thread::spawn(move || listen(&listener, &folder));
        for (method, body) in [("GET", "<p>it</p>"), ("HEAD", "")] {
            let mut stream = TcpStream::connect(address).unwrap();
            write!(stream, "{method} / HTTP/1.1\r\nHost: x\r\n\r\n").unwrap();
            let mut answer = String::new();
            stream.read_to_string(&mut answer).unwrap();
            let (head, got) = answer.split_once("\r\n\r\n").unwrap();
            assert!(head.starts_with("HTTP/1.1 200 OK") && head.contains("Content-Length: 9"));
            assert_eq!(got, body);
        }
    }
}
