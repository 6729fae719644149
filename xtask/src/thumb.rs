//! Stack use and calls of a function in Thumb code, from the relevant instructions. Encodings are those of
//! the ARMv7-M Architecture Reference Manual.
use crate::elf::Function;

/// A relevant instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Act {
    /// Takes bytes from the stack.
    Take(u32),
    /// Sets the stack pointer to a computed value, at this address.
    Unknown(u32),
    /// BL.
    Call(u32),
    /// B, with or without a condition: a jump inside the function, or a tail call of another function.
    Jump(u32),
    /// Continues at an address in a register.
    Indirect,
}

/// The relevant instructions of a function, in the order of its code.
pub fn acts(function: &Function) -> Vec<Act> {
    let mut acts = Vec::new();
    let mut offset = 0;
    while let Some(first) = half(&function.code, offset) {
        let at = function.address + offset as u32;
        if function.is_data(at) {
            offset += 2;
            continue;
        }
        // 0b11101, 0b11110 and 0b11111 begin an instruction of two halves.
        if first >> 11 > 0b11100 {
            let second = half(&function.code, offset + 2).unwrap_or(0);
            acts.extend(wide(first, second, at));
            offset += 4;
        } else {
            acts.extend(narrow(first, at));
            offset += 2;
        }
    }
    acts
}

fn narrow(code: u16, at: u32) -> Option<Act> {
    let code = u32::from(code);
    Some(match code {
        // PUSH {registers, LR}
        0xb400..=0xb5ff => Act::Take(4 * (code & 0x1ff).count_ones()),
        // SUB SP, SP, #imm7 * 4
        0xb080..=0xb0ff => Act::Take(4 * (code & 0x7f)),
        // BX register, but not LR; BLX register
        0x4700..=0x477f if code & 0x78 != 0x70 => Act::Indirect,
        0x4780..=0x47ff => Act::Indirect,
        // MOV PC, register
        _ if code & 0xff87 == 0x4687 => Act::Indirect,
        // MOV SP, register; ADD SP, register
        _ if matches!(code & 0xff87, 0x4685 | 0x4485) => Act::Unknown(at),
        // B<condition> label, but not UDF and SVC; B label
        0xd000..=0xddff => Act::Jump(target(at, (code & 0xff) << 1, 9)),
        0xe000..=0xe7ff => Act::Jump(target(at, (code & 0x7ff) << 1, 12)),
        // CBZ and CBNZ only jump inside a function.
        _ => return None,
    })
}

fn wide(first: u16, second: u16, at: u32) -> Option<Act> {
    let (first, second) = (u32::from(first), u32::from(second));
    let is_branch = first >> 11 == 0b11110 && second & 0x8000 != 0;
    Some(match first {
        // PUSH.W {registers}
        0xe92d => Act::Take(4 * second.count_ones()),
        // VPUSH {S or D registers}: the length is in words.
        0xed2d | 0xed6d => Act::Take(4 * (second & 0xff)),
        // STR register, [SP, #-imm8]!
        0xf84d if second & 0x0f00 == 0x0d00 => Act::Take(second & 0xff),
        // STRD registers, [SP, #-imm8 * 4]!
        0xe96d => Act::Take(4 * (second & 0xff)),
        // SUB.W SP, SP, #constant
        0xf1ad | 0xf5ad if second & 0x8f00 == 0x0d00 => Act::Take(expand(first, second)),
        // SUBW SP, SP, #imm12
        0xf2ad | 0xf6ad if second & 0x8f00 == 0x0d00 => Act::Take(plain(first, second)),
        // SUB.W SP, register, …; ADD.W SP, register, …; MOV.W SP, …
        _ if second & 0x8f00 == 0x0d00 && matches!(first & 0xfbef, 0xf1a0..=0xf1ac | 0xf100..=0xf10c) => {
            Act::Unknown(at)
        }
        0xebad if second & 0x0f00 == 0x0d00 => Act::Unknown(at),
        // LDR PC, …, but not POP of the return address
        _ if first & 0xff70 == 0xf850 && second >> 12 == 15 && first & 15 != 13 => Act::Indirect,
        // BL label; B.W label; B<condition>.W label
        _ if is_branch && second & 0x5000 == 0x5000 => Act::Call(far(first, second, at)),
        _ if is_branch && second & 0x5000 == 0x1000 => Act::Jump(far(first, second, at)),
        _ if is_branch && second & 0x5000 == 0 && first & 0x0380 != 0x0380 => {
            let sign = first >> 10 & 1;
            let bits = sign << 20
                | (second >> 11 & 1) << 19
                | (second >> 13 & 1) << 18
                | (first & 0x3f) << 12
                | (second & 0x7ff) << 1;
            Act::Jump(target(at, bits, 21))
        }
        _ => return None,
    })
}

/// Target of BL and B.W: 25 bits.
fn far(first: u32, second: u32, at: u32) -> u32 {
    let sign = first >> 10 & 1;
    let bit = |j: u32| 1 ^ (second >> j & 1) ^ sign;
    let bits = sign << 24 | bit(13) << 23 | bit(11) << 22 | (first & 0x3ff) << 12 | (second & 0x7ff) << 1;
    target(at, bits, 25)
}

/// An address `bits` wide relative to the instruction, which reads the program counter four bytes ahead.
fn target(at: u32, offset: u32, bits: u32) -> u32 {
    let unused = 32 - bits;
    let offset = ((offset << unused) as i32) >> unused;
    at.wrapping_add(4).wrapping_add_signed(offset)
}

fn plain(first: u32, second: u32) -> u32 {
    (first >> 10 & 1) << 11 | (second >> 12 & 7) << 8 | second & 0xff
}

/// ThumbExpandImm: a byte, repeated or rotated.
fn expand(first: u32, second: u32) -> u32 {
    let code = plain(first, second);
    let byte = code & 0xff;
    match code >> 8 {
        0 => byte,
        1 => byte * 0x0001_0001,
        2 => byte * 0x0100_0100,
        3 => byte * 0x0101_0101,
        _ => (0x80 | byte & 0x7f).rotate_right(code >> 7),
    }
}

fn half(code: &[u8], at: usize) -> Option<u16> {
    Some(u16::from_le_bytes(code.get(at..at + 2)?.try_into().ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(halves: &[u16]) -> Vec<Act> {
        let code = halves.iter().flat_map(|half| half.to_le_bytes()).collect();
        acts(&Function { name: String::new(), address: 0x100, code, data: Vec::new() })
    }

    #[test]
    fn what_is_taken_from_the_stack() {
        // push {r4-r7, lr}; sub sp, #8
        assert_eq!(of(&[0xb5f0, 0xb082]), [Act::Take(20), Act::Take(8)]);
        // push.w {r8-r11}; vpush {d8-d10}
        assert_eq!(of(&[0xe92d, 0x0f00, 0xed2d, 0x8b06]), [Act::Take(16), Act::Take(24)]);
        // sub.w sp, sp, #1024; subw sp, sp, #1060; str r11, [sp, #-4]!
        assert_eq!(of(&[0xf5ad, 0x6d80]), [Act::Take(1024)]);
        assert_eq!(of(&[0xf2ad, 0x4d24]), [Act::Take(0x424)]);
        assert_eq!(of(&[0xf84d, 0xbd04]), [Act::Take(4)]);
        // mov sp, r4; sub.w sp, r7, #16
        assert_eq!(of(&[0x46a5]), [Act::Unknown(0x100)]);
        assert_eq!(of(&[0xf1a7, 0x0d10]), [Act::Unknown(0x100)]);
    }

    #[test]
    fn whom_it_calls() {
        // bl and b.w, 8 bytes ahead; beq.w; bl back to itself
        assert_eq!(of(&[0xf000, 0xf802]), [Act::Call(0x108)]);
        assert_eq!(of(&[0xf000, 0xb802]), [Act::Jump(0x108)]);
        assert_eq!(of(&[0xf000, 0x8002]), [Act::Jump(0x108)]);
        assert_eq!(of(&[0xf7ff, 0xfffe]), [Act::Call(0x100)]);
        // bx lr returns; blx r3 and bx r3 do not
        assert_eq!(of(&[0x4770]), []);
        assert_eq!(of(&[0x4798, 0x4718]), [Act::Indirect, Act::Indirect]);
        // b to itself; beq to itself
        assert_eq!(of(&[0xe7fe, 0xd0fe]), [Act::Jump(0x100), Act::Jump(0x102)]);
    }
}
