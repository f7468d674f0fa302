//! Inputs: files of a corpus with a few changes, of the kinds that disks,
//! editors, other programs and people with bad intent make.

use std::fmt;
use std::sync::Arc;

use proptest::collection::vec;
use proptest::prelude::*;

/// An input, which a failure prints as text.
#[derive(Clone)]
pub(crate) struct Input(pub(crate) Vec<u8>);

impl fmt::Debug for Input {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let shown = &self.0[..self.0.len().min(2000)];
        write!(f, "{:?}", String::from_utf8_lossy(shown))
    }
}

/// What takes the place of a number.
const NUMBERS: &[&str] = &[
    "NaN",
    "-nan",
    "inf",
    "-inf",
    "1e308",
    "-1e308",
    "1e-320",
    "-0",
    "0",
    "1e9",
    "-1e9",
    "1e12",
    "9999999999999999999999",
    "-1",
    "0x7f",
    "1e",
    "1.5.2",
    "2147483647",
    "-2147483648",
    "4294967295",
    "18446744073709551615",
    "65536",
    "0.30000000000000004",
    "1e-9",
    "-9999",
    "1,5",
    "1_000",
    "٣",
    "1e999999999",
];

/// What is put anywhere.
const TEXTS: &[&str] = &[
    "\0",
    "\n",
    "\r",
    "\t",
    "\"",
    "'",
    ",",
    ";",
    "=",
    "[",
    "]",
    "{",
    "}",
    "(",
    ")",
    "<",
    ">",
    "&",
    "#",
    "\\",
    "/",
    "../",
    "$",
    "%",
    "+",
    "-",
    ":",
    "\u{feff}",
    "\u{202e}",
    "\u{200b}",
    "\u{1b}[2J",
    "\u{7f}",
    "\u{85}",
    "é",
    "𝄞",
    "\"\"\"",
    "'''",
    "<!--",
    "]]>",
    "&lt;",
    "<![CDATA[",
    "<?xml?>",
    "=cmd|' /C calc'!A0",
    "\\u0000",
    "\\",
    " ",
    "event",
    "[[a]]",
    "a.b.c",
    "true",
    "1979-05-27",
];

/// What nests when it is repeated.
const NESTS: &[&str] = &["[", "{\"a\":", "(", "<a>", "a=[", "a.", "{a=", "-"];

/// One change: its kind, where, and what with.
type Change = (u8, u32, u32, u16);

/// The files of a corpus with up to six changes each.
pub(crate) fn changed(corpus: Vec<Vec<u8>>) -> impl Strategy<Value = Input> {
    let corpus = Arc::new(corpus);
    let change = (0..20_u8, any::<u32>(), any::<u32>(), any::<u16>());
    (any::<u32>(), vec(change, 0..7)).prop_map(move |(which, changes)| {
        let mut bytes = corpus[at(which, corpus.len())].clone();
        for one in &changes {
            change_once(&mut bytes, one, &corpus);
        }
        Input(bytes)
    })
}

/// A place below `count` by a number of any size; 0 where there is none.
fn at(number: u32, count: usize) -> usize {
    ((u64::from(number) * count as u64) >> 32) as usize
}

fn change_once(bytes: &mut Vec<u8>, change: &Change, corpus: &[Vec<u8>]) {
    let (kind, place, what, size) = *change;
    let here = at(place, bytes.len());
    let till = (here + usize::from(size % 64) + 1).min(bytes.len());
    match kind {
        0 if !bytes.is_empty() => bytes[here] ^= 1 << (what % 8),
        1 if !bytes.is_empty() => bytes[here] = what as u8,
        2 => drop(bytes.drain(here..till)),
        3 => bytes.truncate(here),
        4 => repeat(bytes, here, till, usize::from(size >> 8)),
        5..=9 => put_number(bytes, place, NUMBERS[at(what, NUMBERS.len())]),
        10..=12 => insert(bytes, here, TEXTS[at(what, TEXTS.len())]),
        13 => lines(bytes, place, what, usize::from(size)),
        14 => splice(bytes, here, &corpus[at(what, corpus.len())], size),
        15 => overwrite(bytes, here, what),
        16 => put_digits(bytes, place, what, size),
        17 => nest(bytes, here, what, size),
        18 => swap_words(bytes, place, what),
        _ => drop_line(bytes, place),
    }
}

fn insert(bytes: &mut Vec<u8>, here: usize, text: &str) {
    bytes.splice(here..here, text.bytes());
}

fn repeat(bytes: &mut Vec<u8>, from: usize, till: usize, times: usize) {
    let part = bytes[from..till].repeat(times);
    bytes.splice(from..from, part);
}

/// Where there are numbers.
fn numbers(bytes: &[u8]) -> Vec<(usize, usize)> {
    let is_of_number = |b: &u8| b.is_ascii_digit() || b"+-.".contains(b);
    words(bytes, is_of_number)
}

/// Where there are runs of such bytes.
fn words(bytes: &[u8], of: impl Fn(&u8) -> bool) -> Vec<(usize, usize)> {
    let mut found = Vec::new();
    let mut from = None;
    for (i, byte) in bytes.iter().enumerate() {
        match (of(byte), from) {
            (true, None) => from = Some(i),
            (false, Some(begin)) => {
                found.push((begin, i));
                from = None;
            }
            _ => {}
        }
    }
    found.extend(from.map(|begin| (begin, bytes.len())));
    found
}

fn put_number(bytes: &mut Vec<u8>, place: u32, number: &str) {
    let all = numbers(bytes);
    if let Some((from, till)) = all.get(at(place, all.len())) {
        bytes.splice(*from..*till, number.bytes());
    }
}

/// A number of very many digits, now and then a million.
fn put_digits(bytes: &mut Vec<u8>, place: u32, what: u32, size: u16) {
    let digits = match size {
        0..200 => 1_000_000,
        _ => usize::from(size % 512),
    };
    let digit = char::from(b'0' + (what % 10) as u8).to_string();
    let point = if what.is_multiple_of(3) { "0." } else { "" };
    put_number(bytes, place, &format!("{point}{}", digit.repeat(digits)));
}

/// Something nested, now and then very deep.
fn nest(bytes: &mut Vec<u8>, here: usize, what: u32, size: u16) {
    let depth = match size {
        0..400 => 50_000,
        _ => usize::from(size % 300),
    };
    insert(bytes, here, &NESTS[at(what, NESTS.len())].repeat(depth));
}

/// A line so many times more, now and then very many.
fn lines(bytes: &mut Vec<u8>, place: u32, what: u32, size: usize) {
    let mut all: Vec<&[u8]> = bytes.split_inclusive(|b| *b == b'\n').collect();
    if all.is_empty() {
        return;
    }
    let from = at(place, all.len());
    let to = at(what, all.len());
    let times = if size < 100 { 3000 } else { size % 4 };
    let more = std::iter::repeat_n(all[from], times);
    all.splice(to..to, more);
    *bytes = all.concat();
}

fn drop_line(bytes: &mut Vec<u8>, place: u32) {
    let mut all: Vec<&[u8]> = bytes.split_inclusive(|b| *b == b'\n').collect();
    if !all.is_empty() {
        all.remove(at(place, all.len()));
        *bytes = all.concat();
    }
}

/// The beginning of one file with the end of another.
fn splice(bytes: &mut Vec<u8>, here: usize, other: &[u8], size: u16) {
    bytes.truncate(here);
    let from = at(u32::from(size) << 16, other.len());
    bytes.extend_from_slice(&other[from..]);
}

/// A word of a binary file: a size, a count, an offset.
fn overwrite(bytes: &mut [u8], here: usize, what: u32) {
    const WORDS: [u32; 10] = [
        0,
        1,
        2,
        3,
        0xff,
        0xffff,
        0x1_0000,
        0x7fff_ffff,
        0x8000_0000,
        0xffff_ffff,
    ];
    let word = WORDS[at(what, WORDS.len())];
    let word = match what % 2 {
        0 => word.to_le_bytes(),
        _ => word.to_be_bytes(),
    };
    let width = if what.is_multiple_of(3) { 2 } else { 4 };
    let here = here & !1;
    for (byte, new) in bytes.iter_mut().skip(here).zip(&word[..width]) {
        *byte = *new;
    }
}

/// Two words change places, or one is there twice.
fn swap_words(bytes: &mut Vec<u8>, place: u32, what: u32) {
    let all = words(bytes, |b| b.is_ascii_alphanumeric() || *b == b'_');
    if all.is_empty() {
        return;
    }
    let (from, till) = all[at(place, all.len())];
    let (other, end) = all[at(what, all.len())];
    let word = bytes[other..end].to_vec();
    bytes.splice(from..till, word);
}
