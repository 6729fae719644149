//! What the panic proof wants to know of a 32-bit little-endian ELF file.

/// Names in `.symtab`, mangled; `None` where the file is not what it should be.
pub fn symbols(file: &[u8]) -> Option<Vec<String>> {
    const SYMTAB: u32 = 2;
    if file.get(..6)? != b"\x7fELF\x01\x01" {
        return None;
    }
    let (table, size, count) = (word(file, 0x20)?, half(file, 0x2e)?, half(file, 0x30)?);
    let section = |index: u32| Some(table as usize + index as usize * size as usize);
    let header = (0..u32::from(count)).find_map(|i| {
        let header = section(i)?;
        (word(file, header + 4)? == SYMTAB).then_some(header)
    })?;
    let contents = |header: usize| {
        let start = word(file, header + 16)? as usize;
        file.get(start..start + word(file, header + 20)? as usize)
    };
    let names = contents(section(word(file, header + 24)?)?)?;
    contents(header)?
        .chunks_exact(16)
        .map(|symbol| {
            let name = names.get(word(symbol, 0)? as usize..)?;
            let name = name.split(|&byte| byte == 0).next()?;
            Some(String::from_utf8_lossy(name).into_owned())
        })
        .collect()
}

/// `core::panic::Location`s in a file that holds them: pointer and length of a source path, line, column.
pub fn panic_locations(file: &[u8]) -> Vec<String> {
    let segments = segments(file).unwrap_or_default();
    let text = |address: u32, length: u32| {
        let (start, bytes) = segments.iter().find(|(start, bytes)| {
            address >= *start
                && u64::from(address) + u64::from(length) <= u64::from(*start) + bytes.len() as u64
        })?;
        let at = (address - start) as usize;
        std::str::from_utf8(bytes.get(at..at + length as usize)?).ok().filter(|path| path.ends_with(".rs"))
    };
    let mut found = Vec::new();
    for (_, bytes) in &segments {
        for at in (0..bytes.len()).step_by(4) {
            let words = (word(bytes, at), word(bytes, at + 4), word(bytes, at + 8), word(bytes, at + 12));
            let (Some(address), Some(length), Some(line), Some(column)) = words else { break };
            if let Some(path) = text(address, length).filter(|_| line < 100_000 && column < 1000) {
                let path = path.rsplit_once("/src/").map_or(path, |(before, _)| {
                    let name = before.rfind('/').map_or(0, |slash| slash + 1);
                    path.get(name..).unwrap_or(path)
                });
                found.push(format!("{path}:{line}:{column}"));
            }
        }
    }
    found.sort();
    found.dedup();
    found
}

/// Bytes of flash: everything that is loaded.
pub fn flash(file: &[u8]) -> Option<u64> {
    Some(segments(file)?.iter().map(|(_, bytes)| bytes.len() as u64).sum())
}

/// Bytes that are loaded into flash and copied to RAM at the start: those whose address is another one when the program runs.
pub fn copied(file: &[u8]) -> Option<u64> {
    const LOAD: u32 = 1;
    let (table, size, count) = (word(file, 0x1c)?, half(file, 0x2a)?, half(file, 0x2c)?);
    let headers = (0..u32::from(count)).map(|i| (table + i * u32::from(size)) as usize);
    let mut bytes = 0;
    for header in headers.filter(|&header| word(file, header) == Some(LOAD)) {
        if word(file, header + 8)? != word(file, header + 12)? {
            bytes += u64::from(word(file, header + 16)?);
        }
    }
    Some(bytes)
}

/// Address and bytes of everything that is loaded.
fn segments(file: &[u8]) -> Option<Vec<(u32, &[u8])>> {
    const LOAD: u32 = 1;
    let (table, size, count) = (word(file, 0x1c)?, half(file, 0x2a)?, half(file, 0x2c)?);
    let headers = (0..u32::from(count)).map(|i| (table + i * u32::from(size)) as usize);
    let loaded = headers.filter(|&header| word(file, header) == Some(LOAD));
    loaded
        .map(|header| {
            let (start, length) = (word(file, header + 4)? as usize, word(file, header + 16)? as usize);
            Some((word(file, header + 8)?, file.get(start..start + length)?))
        })
        .collect()
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?))
}

fn half(bytes: &[u8], at: usize) -> Option<u16> {
    Some(u16::from_le_bytes(bytes.get(at..at + 2)?.try_into().ok()?))
}
