//! Whether the tags of a TIFF fit into the file: a small file that says it has
//! millions of values would be given room for them before they are looked for.

/// Bytes of a value, by the type of its tag from 1 on (TIFF 6.0, section 2;
/// BigTIFF has 16 to 18); 0 for none.
const SIZES: [u64; 19] =
    [0, 1, 1, 2, 4, 8, 1, 1, 2, 4, 8, 4, 8, 4, 0, 0, 8, 8, 8];

/// The numbers of a file, in its order of bytes.
struct Numbers<'b> {
    bytes: &'b [u8],
    is_little: bool,
}

impl Numbers<'_> {
    /// The whole number of so many bytes, up to eight.
    fn at(&self, at: u64, width: usize) -> Option<u64> {
        let at = usize::try_from(at).ok()?;
        let bytes = self.bytes.get(at..at.checked_add(width)?)?;
        let add = |sum: u64, byte: &u8| (sum << 8) | u64::from(*byte);
        Some(match self.is_little {
            true => bytes.iter().rev().fold(0, add),
            false => bytes.iter().fold(0, add),
        })
    }
}

/// Whether each tag of the first image has its values within the file. What
/// is no TIFF at all fits, and is for others to refuse.
pub(super) fn fit(bytes: &[u8]) -> bool {
    let numbers = Numbers { bytes, is_little: bytes.starts_with(b"II") };
    all_fit(&numbers).unwrap_or(true)
}

fn all_fit(numbers: &Numbers<'_>) -> Option<bool> {
    let is_big = numbers.at(2, 2)? == 43;
    // How wide an offset is, and the count of the tags.
    let (at, offset, count) = if is_big { (8, 8, 8) } else { (4, 4, 2) };
    let first = numbers.at(at, offset)?;
    let tags = numbers.at(first, count)?;
    let entry = 4 + 2 * offset as u64;
    let length = numbers.bytes.len() as u64;
    for i in 0..tags.min(length) {
        let at = first.checked_add(count as u64 + i * entry)?;
        let kind = usize::try_from(numbers.at(at + 2, 2)?).ok()?;
        let values = numbers.at(at + 4, offset)?;
        let size = SIZES.get(kind).copied().unwrap_or(0);
        if values.checked_mul(size).is_none_or(|size| size > length) {
            return Some(false);
        }
    }
    Some(true)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A head and one tag of this type and count, in either order of bytes.
    fn file(is_little: bool, kind: u16, count: u32) -> Vec<u8> {
        let two = |x: u16| match is_little {
            true => x.to_le_bytes(),
            false => x.to_be_bytes(),
        };
        let four = |x: u32| match is_little {
            true => x.to_le_bytes(),
            false => x.to_be_bytes(),
        };
        let mut all = if is_little { b"II".to_vec() } else { b"MM".to_vec() };
        all.extend(two(42));
        all.extend(four(8));
        all.extend([two(1), two(256), two(kind)].concat());
        all.extend([four(count), four(0)].concat());
        all
    }

    #[test]
    fn a_tag_longer_than_its_file_does_not_fit() {
        for is_little in [true, false] {
            // The file has 22 bytes.
            assert!(fit(&file(is_little, 3, 11)));
            assert!(!fit(&file(is_little, 3, 12)));
            assert!(!fit(&file(is_little, 12, u32::MAX)));
        }
        for cut in 0..22 {
            fit(&file(true, 3, 12)[..cut]);
        }
        assert!(fit(b"no TIFF"));
    }
}
