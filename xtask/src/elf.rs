//! Reads the parts of a 32-bit little-endian ELF file that checks and figures need.
use std::collections::BTreeMap;

/// A section's header: kind, flags, address, place in the file, size, and the number of a section that goes
/// with it.
struct Section {
    kind: u32,
    flags: u32,
    address: u32,
    offset: u32,
    size: u32,
    link: u32,
}

impl Section {
    fn contents<'a>(&self, file: &'a [u8]) -> Option<&'a [u8]> {
        file.get(self.offset as usize..self.offset.checked_add(self.size)? as usize)
    }
}

/// An entry of the symbol table.
struct Symbol {
    /// As the compiler mangled it.
    name: String,
    value: u32,
    size: u32,
    is_function: bool,
}

/// Code under a name.
pub struct Function {
    /// Mangled.
    pub name: String,
    /// Address of its first instruction.
    pub address: u32,
    /// Its bytes.
    pub code: Vec<u8>,
    /// Start and end addresses of data between the instructions.
    pub data: Vec<(u32, u32)>,
}

impl Function {
    /// Whether there is no instruction at this address.
    pub fn is_data(&self, address: u32) -> bool {
        self.data.iter().any(|&(from, to)| (from..to).contains(&address))
    }
}

/// Names in `.symtab`, mangled; `None` if the file has another format.
pub fn symbols(file: &[u8]) -> Option<Vec<String>> {
    Some(symbol_table(file)?.into_iter().map(|symbol| symbol.name).collect())
}

/// All functions, by address, each once.
pub fn functions(file: &[u8]) -> Option<Vec<Function>> {
    const NO_BITS: u32 = 8;
    const EXECUTABLE: u32 = 4;
    let mut symbols = symbol_table(file)?;
    symbols.sort_by_key(|symbol| symbol.value & !1);
    // `$d` and `$t` mark the start of data and of Thumb code.
    let marks: Vec<(u32, bool)> = symbols
        .iter()
        .filter(|symbol| symbol.name.starts_with("$d") || symbol.name.starts_with("$t"))
        .map(|symbol| (symbol.value, symbol.name.starts_with("$d")))
        .collect();
    let code = sections(file)?.into_iter().filter(|s| s.flags & EXECUTABLE != 0 && s.kind != NO_BITS);
    let code: Vec<Section> = code.collect();
    let mut found: Vec<Function> = Vec::new();
    for symbol in symbols.iter().filter(|symbol| symbol.is_function && symbol.size > 0) {
        let (address, size) = (symbol.value & !1, symbol.size);
        let section = code.iter().find(|s| (s.address..s.address + s.size).contains(&address))?;
        let from = (address - section.address) as usize;
        let bytes = section.contents(file)?.get(from..from + size as usize)?;
        let ends = marks.iter().skip(1).map(|&(to, _)| to).chain([u32::MAX]);
        let data = marks
            .iter()
            .zip(ends)
            .filter(|&(&(at, is_data), to)| is_data && to > address && at < address + size);
        let data = data.map(|(&(at, _), to)| (at, to)).collect();
        if found.last().is_none_or(|last| last.address != address) {
            found.push(Function { name: symbol.name.clone(), address, code: bytes.to_vec(), data });
        }
    }
    Some(found)
}

/// Bytes of flash by module of the library; other bytes as `other`, including tables that belong to no named
/// module.
pub fn by_module(file: &[u8]) -> Option<BTreeMap<String, u64>> {
    const NAME: &str = "9glidepath";
    const RAM: u32 = 0x2000_0000;
    let mut symbols = symbol_table(file)?;
    symbols.retain(|symbol| symbol.value < RAM && symbol.size > 0);
    symbols.sort_by_key(|symbol| symbol.value & !1);
    symbols.dedup_by_key(|symbol| symbol.value & !1);
    let mut bytes = BTreeMap::new();
    for symbol in &symbols {
        let module = symbol.name.split_once(NAME).and_then(|(_, rest)| {
            let digits = rest.find(|c: char| !c.is_ascii_digit())?;
            rest.get(digits..digits + rest.get(..digits)?.parse::<usize>().ok()?)
        });
        *bytes.entry(module.unwrap_or("other").to_owned()).or_default() += u64::from(symbol.size);
    }
    let named: u64 = bytes.values().sum();
    *bytes.entry("other".to_owned()).or_default() += flash(file)?.saturating_sub(named);
    Some(bytes)
}

/// Constant data that may contain addresses of functions: all loaded data except code and the vector table.
pub fn tables(file: &[u8]) -> Option<Vec<&[u8]>> {
    const LOADED: u32 = 2;
    const EXECUTABLE: u32 = 4;
    const PROGRAM_BITS: u32 = 1;
    let mut sections = sections(file)?;
    sections.retain(|s| s.kind == PROGRAM_BITS && s.flags & LOADED != 0 && s.flags & EXECUTABLE == 0);
    // The vector table comes first.
    let first = sections.iter().map(|section| section.address).min();
    sections.iter().filter(|s| Some(s.address) != first).map(|section| section.contents(file)).collect()
}

fn sections(file: &[u8]) -> Option<Vec<Section>> {
    if file.get(..6)? != b"\x7fELF\x01\x01" {
        return None;
    }
    let (table, size, count) = (word(file, 0x20)?, half(file, 0x2e)?, half(file, 0x30)?);
    let headers = (0..u32::from(count)).map(|i| (table + i * u32::from(size)) as usize);
    headers
        .map(|header| {
            Some(Section {
                kind: word(file, header + 4)?,
                flags: word(file, header + 8)?,
                address: word(file, header + 12)?,
                offset: word(file, header + 16)?,
                size: word(file, header + 20)?,
                link: word(file, header + 24)?,
            })
        })
        .collect()
}

fn symbol_table(file: &[u8]) -> Option<Vec<Symbol>> {
    const SYMTAB: u32 = 2;
    const FUNCTION: u8 = 2;
    let sections = sections(file)?;
    let table = sections.iter().find(|section| section.kind == SYMTAB)?;
    let names = sections.get(table.link as usize)?.contents(file)?;
    let symbols = table.contents(file)?.chunks_exact(16).map(|symbol| {
        let name = names.get(word(symbol, 0)? as usize..)?;
        let name = String::from_utf8_lossy(name.split(|&byte| byte == 0).next()?).into_owned();
        let is_function = symbol.get(12)? & 15 == FUNCTION;
        Some(Symbol { name, value: word(symbol, 4)?, size: word(symbol, 8)?, is_function })
    });
    symbols.collect()
}

/// `core::panic::Location`s in a file: pointer and length of a source path, line, column.
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

/// Bytes of flash: all loaded bytes.
pub fn flash(file: &[u8]) -> Option<u64> {
    Some(segments(file)?.iter().map(|(_, bytes)| bytes.len() as u64).sum())
}

/// Bytes that are loaded into flash and copied to RAM at the start: bytes whose address differs at run time.
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

/// Address and bytes of all loaded data.
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
