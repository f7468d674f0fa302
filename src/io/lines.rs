//! The lines of a data file, tidied and checked before they are taken apart.

use std::io::{self, BufRead, BufReader, Read};

use super::words::{breaks_line, quoted};

/// The longest line of a data file, in bytes: three numbers need far less,
/// and what has no line ends is no table.
const LONGEST: u64 = 1000;

/// Passes on the lines of a text: without a byte order mark, every one ended
/// by `\n` alone. A line that is no text ends it with
/// [`io::ErrorKind::InvalidData`] and a message that begins with its number.
#[derive(Debug)]
pub(super) struct Lines<R> {
    source: BufReader<R>,
    line: Vec<u8>,
    given: usize,
    number: u64,
}

impl<R: Read> Lines<R> {
    pub(super) fn new(source: R) -> Self {
        let source = BufReader::new(source);
        Self { source, line: Vec::new(), given: 0, number: 0 }
    }

    /// Reads the next line; false at the end.
    fn advance(&mut self) -> io::Result<bool> {
        self.line.clear();
        self.given = 0;
        let mut short = (&mut self.source).take(LONGEST + 1);
        if short.read_until(b'\n', &mut self.line)? == 0 {
            return Ok(false);
        }
        self.number += 1;
        if self.number == 1 && self.line.starts_with(b"\xef\xbb\xbf") {
            self.line.drain(..3);
        }
        self.check()?;
        while self.line.last().is_some_and(u8::is_ascii_whitespace) {
            self.line.pop();
        }
        self.line.push(b'\n');
        Ok(true)
    }

    fn check(&self) -> io::Result<()> {
        let refuse = |what: String| {
            let text = format!(
                "{}: {what}; expected a CSV table saved as UTF-8 text",
                self.number
            );
            Err(io::Error::new(io::ErrorKind::InvalidData, text))
        };
        if self.line.len() as u64 > LONGEST {
            return refuse(format!("the line is over {LONGEST} bytes long"));
        }
        let Ok(text) = std::str::from_utf8(&self.line) else {
            return refuse("the line is not UTF-8 text".to_owned());
        };
        let text = text.trim_end();
        if text.chars().any(|c| breaks_line(c) && c != '\t') {
            return refuse(format!(
                "the line has control characters, {}",
                quoted(text)
            ));
        }
        Ok(())
    }
}

impl<R: Read> Read for Lines<R> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        if self.given == self.line.len() && !self.advance()? {
            return Ok(0);
        }
        let rest = &self.line[self.given..];
        let count = rest.len().min(into.len());
        into[..count].copy_from_slice(&rest[..count]);
        self.given += count;
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tidied(text: &[u8]) -> io::Result<String> {
        let mut out = String::new();
        Lines::new(text).read_to_string(&mut out)?;
        Ok(out)
    }

    #[test]
    fn lines_come_out_tidy() {
        let text = b"\xef\xbb\xbft,v\r\n1,2 \r\n\n3,4";
        assert_eq!(tidied(text).unwrap(), "t,v\n1,2\n\n3,4\n");
        assert_eq!(tidied(b"").unwrap(), "");
    }

    #[test]
    fn what_is_no_text_is_refused_with_its_line() {
        for text in [
            &b"t,v\n\xff\xfe"[..],
            b"t,v\n1\x00,2",
            &[b"t\n", &[b'7'; 2000][..]].concat(),
        ] {
            let error = tidied(text).unwrap_err();
            assert_eq!(error.kind(), io::ErrorKind::InvalidData);
            assert!(error.to_string().starts_with("2: "), "{error}");
        }
    }
}
