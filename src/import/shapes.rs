//! The lines of a shapefile (ESRI 1998, "ESRI Shapefile Technical
//! Description"): what a path is, and nothing else that such a file may hold.
//!
//! Every count is compared with what is there before there is room for it: a
//! small file cannot ask for much memory.

use super::crs::Place;

/// What a file begins with, and how long that is in bytes.
const CODE: i32 = 9994;
const HEADER: usize = 100;

/// Lines: plain, with heights, with measures.
const LINES: [i32; 3] = [3, 13, 23];

/// Where the counts of a line's parts and points stand in its record, behind
/// its kind and the box about it, and where the parts begin.
const COUNTS: usize = 36;
const PARTS: usize = 44;

/// The lines of all records.
pub(super) fn lines(bytes: &[u8]) -> Result<Vec<Vec<Place>>, &'static str> {
    let code = bytes.get(..HEADER).map(|head| big(head, 0));
    if code != Some(Some(CODE)) {
        return Err("it does not begin as one");
    }
    let words = big(bytes, 24).and_then(|words| usize::try_from(words).ok());
    let end = words.and_then(|words| words.checked_mul(2));
    let end = end.ok_or("its length is negative")?;
    let mut rest = bytes.get(HEADER..end).ok_or("it is cut off")?;
    let mut lines = Vec::new();
    while !rest.is_empty() {
        let (record, behind) = record(rest).ok_or("a record is cut off")?;
        if LINES.iter().any(|kind| little(record, 0) == Some(*kind)) {
            lines.extend(line(record).ok_or("a line is no line")?);
        }
        rest = behind;
    }
    Ok(lines)
}

/// The first record, and what is behind it.
fn record(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let words = usize::try_from(big(bytes, 4)?).ok()?;
    bytes.get(8..)?.split_at_checked(words.checked_mul(2)?)
}

/// The parts of a line: each begins at the point of this number and ends
/// where the next one begins.
fn line(record: &[u8]) -> Option<Vec<Vec<Place>>> {
    let count = |at| usize::try_from(little(record, at)?).ok();
    let (parts, points) = (count(COUNTS)?, count(COUNTS + 4)?);
    let (starts, rest) =
        record.get(PARTS..)?.split_at_checked(parts.checked_mul(4)?)?;
    let points = rest.get(..points.checked_mul(16)?)?;
    let points: Vec<Place> = points.chunks_exact(16).map(place).collect();
    let starts = starts.chunks_exact(4).map(|start| little(start, 0));
    let starts = starts.map(|start| usize::try_from(start?).ok());
    let starts: Vec<usize> = starts.collect::<Option<_>>()?;
    let ends = starts.iter().skip(1).copied().chain([points.len()]);
    let part = |(from, to): (&usize, usize)| points.get(*from..to);
    let parts = starts.iter().zip(ends).map(part);
    parts.map(|part| part.map(<[Place]>::to_vec)).collect()
}

fn place(bytes: &[u8]) -> Place {
    let number = |at: usize| {
        let bytes = bytes.get(at..at + 8).and_then(|b| b.try_into().ok());
        bytes.map_or(f64::NAN, f64::from_le_bytes)
    };
    (number(0), number(8))
}

fn word(bytes: &[u8], at: usize) -> Option<[u8; 4]> {
    bytes.get(at..at + 4)?.try_into().ok()
}

fn little(bytes: &[u8], at: usize) -> Option<i32> {
    word(bytes, at).map(i32::from_le_bytes)
}

fn big(bytes: &[u8], at: usize) -> Option<i32> {
    word(bytes, at).map(i32::from_be_bytes)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A shapefile of one record, which is a line of these parts.
    pub(in super::super) fn shapefile(parts: &[&[Place]]) -> Vec<u8> {
        let mut line = 3_i32.to_le_bytes().to_vec();
        line.extend([0; 32]);
        let points: Vec<&Place> = parts.iter().copied().flatten().collect();
        for count in [parts.len(), points.len()] {
            line.extend((count as i32).to_le_bytes());
        }
        let mut start = 0_i32;
        for part in parts {
            line.extend(start.to_le_bytes());
            start += part.len() as i32;
        }
        for (x, y) in points {
            line.extend([x.to_le_bytes(), y.to_le_bytes()].concat());
        }
        let mut file = vec![0; HEADER];
        file[..4].copy_from_slice(&CODE.to_be_bytes());
        let words = ((HEADER + 8 + line.len()) / 2) as i32;
        file[24..28].copy_from_slice(&words.to_be_bytes());
        file.extend(1_i32.to_be_bytes());
        file.extend((line.len() as i32 / 2).to_be_bytes());
        file.extend(line);
        file
    }

    #[test]
    fn every_part_is_a_line() {
        let (one, two) = ([(0.0, 1.0), (2.0, 3.0)], [(4.0, 5.0); 3]);
        let file = shapefile(&[&one, &two]);
        assert_eq!(lines(&file).unwrap(), [one.to_vec(), two.to_vec()]);
        // Points and areas are passed over.
        let mut points = file.clone();
        points[HEADER + 8] = 8;
        assert_eq!(lines(&points).unwrap(), Vec::<Vec<Place>>::new());
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let file = shapefile(&[&[(0.0, 1.0), (2.0, 3.0)]]);
        let record = HEADER + 8;
        let spoilt = |at: usize, word: [u8; 4]| {
            let mut bytes = file.clone();
            bytes[at..at + 4].copy_from_slice(&word);
            lines(&bytes)
        };
        let most = i32::MAX.to_le_bytes();
        for (at, word, why) in [
            (0, [0; 4], "it does not begin as one"),
            (24, [0xff; 4], "its length is negative"),
            (24, i32::MAX.to_be_bytes(), "it is cut off"),
            (HEADER + 4, 1000_i32.to_be_bytes(), "a record is cut off"),
            (record + COUNTS, most, "a line is no line"),
            (record + COUNTS + 4, most, "a line is no line"),
            (record + COUNTS + 4, [0xff; 4], "a line is no line"),
            (record + PARTS, most, "a line is no line"),
        ] {
            assert_eq!(spoilt(at, word), Err(why), "{at}");
        }
        assert!(lines(&file[..file.len() - 1]).is_err());
        assert!(lines(&[]).is_err());
    }
}
