//! Upper bound of the stack, from the machine code of a firmware: the bound includes every frame and every
//! path.
//!
//! A frame is the sum of all stack that a function takes. The program follows calls through the whole binary.
//! A call through a pointer may reach any function whose address is in a table. Recursion, and frames of
//! unknown size, are errors.
use crate::elf::{self, Function};
use crate::thumb::{self, Act};
use std::collections::{BTreeMap, BTreeSet};

/// A function with its frame and its calls.
#[derive(Debug, Default)]
struct Node {
    name: String,
    frame: u32,
    calls: BTreeSet<u32>,
    /// Whether the function calls through a pointer.
    indirect: bool,
}

/// The calls of a whole binary.
#[derive(Debug, Default)]
pub struct Calls {
    nodes: BTreeMap<u32, Node>,
    /// Functions whose address is in a table.
    pointed: Vec<u32>,
}

/// The deepest chain of calls from a function.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Depth {
    /// Bytes, those of the function itself included.
    pub bytes: u32,
    /// Name and frame of each function in the chain.
    pub chain: Vec<(String, u32)>,
}

impl Calls {
    /// Reads the calls from an ELF file.
    pub fn read(file: &[u8]) -> Result<Self, String> {
        let functions = elf::functions(file).ok_or("no symbols of functions")?;
        let known: BTreeSet<u32> = functions.iter().map(|function| function.address).collect();
        let tables = elf::tables(file).ok_or("no sections")?;
        let words = tables.iter().flat_map(|bytes| bytes.chunks_exact(4));
        let words = words.filter_map(|word| Some(u32::from_le_bytes(word.try_into().ok()?)));
        let mut pointed: Vec<u32> =
            words.filter(|word| word & 1 == 1 && known.contains(&(word - 1))).map(|word| word - 1).collect();
        pointed.sort_unstable();
        pointed.dedup();
        let nodes = functions.iter().map(|function| Ok((function.address, node(function, &known)?)));
        Ok(Self { nodes: nodes.collect::<Result<_, String>>()?, pointed })
    }

    /// The deepest chain of calls from the only function whose name contains `root`.
    pub fn depth(&self, root: &str) -> Result<Depth, String> {
        let mut found = self.nodes.iter().filter(|(_, node)| node.name.contains(root));
        let (Some((&address, _)), None) = (found.next(), found.next()) else {
            return Err(format!("not one function is called {root}"));
        };
        let mut known = BTreeMap::new();
        self.below(address, &mut Vec::new(), &mut known)
    }

    fn below(
        &self,
        address: u32,
        path: &mut Vec<u32>,
        known: &mut BTreeMap<u32, Depth>,
    ) -> Result<Depth, String> {
        if let Some(depth) = known.get(&address) {
            return Ok(depth.clone());
        }
        let Some(node) = self.nodes.get(&address) else {
            return Err(format!("no function at {address:#x}"));
        };
        if path.contains(&address) {
            return Err(format!("{} calls itself", node.name));
        }
        path.push(address);
        let mut deepest = Depth::default();
        let pointed = if node.indirect { self.pointed.as_slice() } else { &[] };
        for &callee in node.calls.iter().chain(pointed) {
            let depth = self.below(callee, path, known)?;
            if depth.bytes > deepest.bytes {
                deepest = depth;
            }
        }
        path.pop();
        deepest.bytes += node.frame;
        deepest.chain.insert(0, (node.name.clone(), node.frame));
        known.insert(address, deepest.clone());
        Ok(deepest)
    }
}

/// Prints the deepest chains of calls from some functions of a firmware.
pub fn show(file: &str, roots: &[&str]) -> Result<(), String> {
    let bytes = std::fs::read(file).map_err(|e| format!("{file}: {e}"))?;
    let calls = Calls::read(&bytes)?;
    for root in roots {
        let depth = calls.depth(root)?;
        eprintln!("{root}: {} bytes", depth.bytes);
        for (name, frame) in depth.chain {
            eprintln!("   {frame:>6}  {name}");
        }
    }
    Ok(())
}

fn node(function: &Function, known: &BTreeSet<u32>) -> Result<Node, String> {
    let mut node = Node { name: function.name.clone(), ..Node::default() };
    let end = function.address + function.code.len() as u32;
    for act in thumb::acts(function) {
        match act {
            Act::Take(bytes) => node.frame += bytes,
            Act::Unknown(at) => {
                return Err(format!("{}: a frame of unknown size at {at:#x}", function.name));
            }
            Act::Indirect => node.indirect = true,
            Act::Call(to) if known.contains(&to) => {
                node.calls.insert(to);
            }
            Act::Jump(to) if (function.address..end).contains(&to) => {}
            Act::Jump(to) if known.contains(&to) => {
                node.calls.insert(to);
            }
            Act::Call(to) | Act::Jump(to) => {
                return Err(format!("{}: a call of {to:#x}, which is no function", function.name));
            }
        }
    }
    Ok(node)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn calls(nodes: &[(u32, &str, u32, &[u32], bool)], pointed: &[u32]) -> Calls {
        let nodes = nodes.iter().map(|&(address, name, frame, calls, indirect)| {
            let calls = calls.iter().copied().collect();
            (address, Node { name: name.into(), frame, calls, indirect })
        });
        Calls { nodes: nodes.collect(), pointed: pointed.to_vec() }
    }

    #[test]
    fn the_deepest_way_counts() {
        let calls = calls(
            &[
                (0, "root", 8, &[2, 4], false),
                (2, "wide", 100, &[], false),
                (4, "way", 16, &[6], true),
                (6, "leaf", 4, &[], false),
                (8, "pointed", 90, &[], false),
            ],
            &[8],
        );
        let depth = calls.depth("root").unwrap_or_default();
        assert_eq!(depth.bytes, 8 + 16 + 90);
        assert_eq!(depth.chain.last(), Some(&("pointed".into(), 90)));
        assert!(calls.depth("nobody").is_err());
    }

    #[test]
    fn recursion_has_no_bound() {
        let calls = calls(&[(0, "root", 8, &[2], false), (2, "again", 8, &[0], false)], &[]);
        assert!(calls.depth("root").is_err());
    }
}
