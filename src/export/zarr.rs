//! InferenceData in Zarr.
//!
//! The format is version 2, with consolidated metadata and the attribute
//! `_ARRAY_DIMENSIONS`, by which xarray names dimensions: ArviZ 0.23 reads
//! nothing newer (it asks for zarr below 3), and newer programs read it too.
//! An array is one chunk, without compression.

use std::sync::Arc;

use serde_json::{Map, Value, json};
use zarrs::array::{
    Array, ArrayBytes, ArrayMetadata, ArrayMetadataOptions, CodecOptions,
};
use zarrs::group::{Group as ZarrGroup, GroupMetadata};
use zarrs::storage::store::MemoryStore;
use zarrs::storage::{ListableStorageTraits, ReadableStorageTraits};

use super::data::{Group, InferenceData, Values, Variable};
use crate::error::{Error, Result};

/// The files of a Zarr hierarchy, by their names in its folder; the names
/// have `/` between their parts.
///
/// Each array has its dimensions, unit and meaning as attributes
/// (`_ARRAY_DIMENSIONS`, `units`, `long_name`); the attributes of the whole
/// are those of each group, too, since ArviZ shows them there.
///
/// ```
/// use couloir::draws::Draws;
/// use couloir::export::{of_draws, zarr};
/// let names = || vec!["mu".to_owned()];
/// let mut draws = Draws::new(names(), vec!["1".to_owned()])?;
/// draws.push_chain(vec![0.2, 0.3], None)?;
/// let files = zarr(&of_draws(&draws, &[])?)?;
/// let mu = files.iter().find(|(name, _)| name == "posterior/mu/0.0");
/// let bytes = [0.2_f64.to_le_bytes(), 0.3_f64.to_le_bytes()].concat();
/// assert_eq!(mu.map(|(_, bytes)| bytes), Some(&bytes));
/// # Ok::<(), couloir::Error>(())
/// ```
///
/// # Errors
/// What the format cannot hold; nothing of what [`gather`](super::gather)
/// makes.
pub fn zarr(data: &InferenceData) -> Result<Vec<(String, Vec<u8>)>> {
    let store = Arc::new(MemoryStore::new());
    let shared = attributes(&data.attributes);
    write_group(&store, "/", shared.clone())?;
    for group in &data.groups {
        let mut all = shared.clone();
        all.extend(attributes(&group.attributes));
        write_group(&store, &format!("/{}", group.name), all)?;
        for variable in &group.variables {
            write_variable(&store, group, variable)?;
        }
    }
    files(&store)
}

fn attributes(all: &[(String, String)]) -> Map<String, Value> {
    all.iter().map(|(key, value)| (key.clone(), json!(value))).collect()
}

/// What the crate says of a failure.
fn failed(error: impl std::fmt::Display) -> Error {
    Error::system(format!("the draws could not be put as Zarr: {error}"))
}

fn write_group(
    store: &Arc<MemoryStore>,
    path: &str,
    attributes: Map<String, Value>,
) -> Result<()> {
    let empty = json!({"zarr_format": 2});
    let empty: GroupMetadata =
        serde_json::from_value(empty).map_err(failed)?;
    let group = ZarrGroup::new_with_metadata(store.clone(), path, empty);
    let mut group = group.map_err(failed)?;
    group.attributes_mut().extend(attributes);
    group.store_metadata().map_err(failed)
}

fn write_variable(
    store: &Arc<MemoryStore>,
    group: &Group,
    variable: &Variable,
) -> Result<()> {
    let path = format!("/{}/{}", group.name, variable.name);
    let about: ArrayMetadata =
        serde_json::from_value(metadata(variable)).map_err(failed)?;
    let array = Array::new_with_metadata(store.clone(), &path, about);
    let array = array.map_err(failed)?;
    let plain =
        ArrayMetadataOptions::default().with_include_zarrs_metadata(false);
    array.store_metadata_opt(&plain).map_err(failed)?;
    // A chunk of zeros is a chunk: nothing says what else a reader would take.
    let options = CodecOptions::default().with_store_empty_chunks(true);
    let only = vec![0; variable.shape.len()];
    let stored = match &variable.values {
        Values::Real(x) => array.store_chunk_opt(&only, x, &options),
        Values::Whole(x) => array.store_chunk_opt(&only, x, &options),
        Values::Words(x) => {
            let bytes = ArrayBytes::new_flen(utf32(x));
            array.store_chunk_opt(&only, bytes, &options)
        }
    };
    stored.map_err(failed)
}

/// What stands in `.zarray` and `.zattrs`.
fn metadata(variable: &Variable) -> Value {
    let (kind, fill) = match &variable.values {
        Values::Real(_) => ("<f8".to_owned(), json!("NaN")),
        Values::Whole(_) => ("<i8".to_owned(), Value::Null),
        Values::Words(words) => (format!("<U{}", longest(words)), json!("")),
    };
    let mut about = json!({"_ARRAY_DIMENSIONS": variable.dimensions});
    let told = [("units", &variable.unit), ("long_name", &variable.about)];
    for (key, value) in told.into_iter().filter(|(_, v)| !v.is_empty()) {
        about[key] = json!(value);
    }
    json!({
        "zarr_format": 2, "shape": variable.shape, "chunks": variable.shape,
        "dtype": kind, "fill_value": fill, "order": "C",
        "compressor": null, "filters": null, "attributes": about,
    })
}

/// How many characters the longest of the words has.
fn longest(words: &[String]) -> usize {
    let counts = words.iter().map(|word| word.chars().count());
    counts.max().unwrap_or(0).max(1)
}

/// Words of one length, filled with zeros, as UTF-32 with the low byte first.
fn utf32(words: &[String]) -> Vec<u8> {
    let longest = longest(words);
    let one = |word: &String| {
        let filled = word.chars().map(u32::from).chain(std::iter::repeat(0));
        let bytes = filled.take(longest).flat_map(u32::to_le_bytes);
        bytes.collect::<Vec<_>>()
    };
    words.iter().flat_map(one).collect()
}

/// The files of the store, and the metadata of all in one file, as
/// zarr-python writes it (`.zmetadata`).
fn files(store: &MemoryStore) -> Result<Vec<(String, Vec<u8>)>> {
    let mut files = Vec::new();
    let mut all = Map::new();
    for key in store.list().map_err(failed)? {
        let Some(bytes) = store.get(&key).map_err(failed)? else { continue };
        let name = key.as_str().to_owned();
        let last = name.rsplit('/').next().unwrap_or_default();
        if [".zgroup", ".zarray", ".zattrs"].contains(&last) {
            let value = serde_json::from_slice(&bytes).map_err(failed)?;
            all.insert(name.clone(), value);
        }
        files.push((name, bytes.to_vec()));
    }
    let all = json!({"zarr_consolidated_format": 1, "metadata": all});
    files.push((".zmetadata".to_owned(), format!("{all:#}\n").into_bytes()));
    Ok(files)
}
