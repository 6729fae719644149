//! The symbol names of a 32-bit little-endian ELF file.

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

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?))
}

fn half(bytes: &[u8], at: usize) -> Option<u16> {
    Some(u16::from_le_bytes(bytes.get(at..at + 2)?.try_into().ok()?))
}
