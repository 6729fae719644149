//! Machine data that only programs of LinuxCNC, Grbl and Fanuc need. These parameters are Glidepath's own;
//! ISG has no numbers for them.

/// The dialect: the language in which programs are written.
///
/// The same word may mean different things: `G20` mirrors in ISG's language and switches to inches in the others.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Dialect {
    /// ISG's language, DIN 66025 with extensions.
    #[default]
    Isg,
    /// LinuxCNC's RS274/NGC.
    LinuxCnc,
    /// Grbl 1.1, with words of grblHAL and FluidNC.
    Grbl,
    /// Fanuc's controllers for mills, without macro B.
    #[cfg(feature = "fanuc")]
    Fanuc,
}

impl Dialect {
    /// All dialects.
    pub const ALL: &'static [Self] = &[
        Self::Isg,
        Self::LinuxCnc,
        Self::Grbl,
        #[cfg(feature = "fanuc")]
        Self::Fanuc,
    ];

    /// Whether this is Fanuc's dialect.
    pub const fn is_fanuc(self) -> bool {
        #[cfg(feature = "fanuc")]
        return matches!(self, Self::Fanuc);
        #[cfg(not(feature = "fanuc"))]
        false
    }

    /// The name in machine data and on command lines: `isg`, `linuxcnc`, `grbl`, `fanuc`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Isg => "isg",
            Self::LinuxCnc => "linuxcnc",
            Self::Grbl => "grbl",
            #[cfg(feature = "fanuc")]
            Self::Fanuc => "fanuc",
        }
    }
}

/// Number of zero offsets in addition to G54…G59: G59.1, G59.2, G59.3.
pub const MORE_OFFSETS: usize = 3;

/// Number of tools that a table of lengths holds.
pub const TOOLS: usize = 32;

/// Tool lengths by tool number, for G43 H.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ToolLengths {
    tools: [(u32, i32); TOOLS],
    len: u8,
}

impl ToolLengths {
    /// A table without tools.
    pub const NONE: Self = Self { tools: [(0, 0); TOOLS], len: 0 };

    /// Adds or changes the length of tool `number`, in 0.1 µm. Tools beyond [`TOOLS`] are left out.
    #[must_use]
    pub fn with(mut self, number: u32, length: i32) -> Self {
        let len = usize::from(self.len);
        let known = self.tools.iter_mut().take(len).find(|tool| tool.0 == number);
        if let Some(tool) = known {
            tool.1 = length;
        } else if let Some(slot) = self.tools.get_mut(len) {
            *slot = (number, length);
            self.len += 1;
        }
        self
    }

    /// The length of tool `number`, 0.1 µm; `None` for a tool that is not in the table.
    pub fn of(&self, number: u32) -> Option<i32> {
        self.tools.iter().take(self.len.into()).find(|tool| tool.0 == number).map(|tool| tool.1)
    }

    /// Whether no tool is in the table.
    pub const fn is_empty(&self) -> bool {
        self.len == 0
    }
}

/// The dialect of a channel, and data that only dialects other than ISG's need.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct ForeignChannel {
    /// `dialect`: the dialect of the channel's programs.
    pub dialect: Dialect,
    /// `blend_tolerance`: largest distance from the programmed path for a G64 without P, µm.
    pub blend_tolerance_um: u32,
    /// `block_delete`: whether lines that begin with `/` are skipped.
    pub block_delete: bool,
    /// `optional_stop`: whether M1 pauses the program.
    pub optional_stop: bool,
    /// `tool_length[n]`: lengths for G43, along the third main axis.
    pub tools: ToolLengths,
}

impl ForeignChannel {
    /// The values for ISG's language.
    pub const ISG: Self = Self {
        dialect: Dialect::Isg,
        blend_tolerance_um: 20,
        block_delete: false,
        optional_stop: false,
        tools: ToolLengths::NONE,
    };
}

/// Data of an axis that only dialects other than ISG's need, in 0.1 µm (rotary: 0.0001°), machine
/// coordinates.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ForeignAxis {
    /// `np_grp.7.versch`…`np_grp.9.versch`: zero offsets of G59.1…G59.3.
    pub versch: [i32; MORE_OFFSETS],
    /// `g28` and `g30`: the stored positions for G28 and G30.
    pub stored: [i32; 2],
}

impl ForeignAxis {
    /// All values 0.
    pub const NONE: Self = Self { versch: [0; MORE_OFFSETS], stored: [0; 2] };
}
