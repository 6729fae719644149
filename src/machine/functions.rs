//! Functions that a build may leave out. Each function is a Cargo feature. The features are on by default,
//! except for those marked `off by default` in the table.
//!
//! A build without a function refuses programs and machine data that need the function, and names the missing
//! feature. Words that switch the function off are accepted. The code tests one of these constants where a
//! function starts, so the linker drops the rest of the function.
//!
//! | feature | commands | without it |
//! |---|---|---|
//! | `isg` (always there without `grbl`, brings `slopes`) | programs of ISG's controllers | programs are those of Grbl or LinuxCNC |
//! | `slopes` (always there without `grbl`, needed by `isg`) | the slopes STEP and SIN2: P-CHAN-00071 = 0, 2 | |
//! | `contour` (needs `isg`) | G61, G261, `#CONTOUR MODE`, `#HSC` | blocks end at their programmed points |
//! | `surface` (needs `contour` and `hsc`) | `#HSC [SURFACE]` | |
//! | `splines` (needs `contour` and `hsc`) | G151, `#SPLINE`, `#AKIMA`, `#HSC [BSPLINE]`, `#HSC [OPMODE=2]` | |
//! | `hsc` | the slope HSC: `#SLOPE [TYPE=HSC]`, P-CHAN-00071 = 3 | |
//! | `expressions` (needs `isg`) | `P` parameters, operators and functions, `$` statements | words have plain numbers; subroutines stay |
//! | `filters` | `#FILTER`, P-AXIS-00586 | |
//! | `beside` | single axes: `[OSC …]`, `[INDP …]`, `#WAIT INDP` | |
//! | `grbl` (off by default) | the words of Grbl 1.1 | programs are ISG's |
//! | `dialects` (off by default, brings `grbl`) | the words of LinuxCNC; parameters, O words, `M98` and cycles of Grbl's programs | |
//! | `fanuc` (off by default, brings `dialects`) | the words of Fanuc's controllers | |
//! | `kinematics` (off by default, needs `hsc` and `isg`) | `#KIN ID`, `#TRAFO` | |
//! | `plc` (off by default, needs `isg`) | `#CONTOUR LOOKAHEAD LOG`, `#DISTANCE PROG START CLEAR`, `#RT WHILE`, `#FLUSH`, `V.` variables | |
//!
//! The feature `fast` is not a function. With `fast` the compiler copies more functions into their callers,
//! and the table of sines is larger. Set points have the same bits with and without `fast`.

/// A function that may be left out of a build.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Function {
    built: bool,
    needs: &'static str,
}

impl Function {
    /// Whether the function is compiled in.
    #[inline(always)]
    pub const fn is_built(self) -> bool {
        self.built
    }

    /// Returns `count` if the function is compiled in, otherwise 0. Use it for the size of memory that only
    /// this function needs.
    pub const fn room(self, count: usize) -> usize {
        if self.built { count } else { 0 }
    }

    /// Checks that the function is compiled in.
    ///
    /// # Errors
    /// Returns a message with the missing function and the feature to enable.
    #[inline(always)]
    pub const fn check(self) -> Result<(), &'static str> {
        if self.built { Ok(()) } else { Err(self.needs) }
    }
}

/// Whether this is a small build: a build without Surface and splines. A small build has less room in the
/// queue.
pub const IS_SMALL: bool = !SURFACE.is_built() && !SPLINES.is_built();

/// Programs of ISG's controllers. A build without any other language always has them.
pub const ISG: Function = Function {
    built: cfg!(any(feature = "isg", not(feature = "grbl"))),
    needs: "a program of ISG's controllers is not in this build; expected the library's feature `isg`, or \
            ChannelData::foreign.dialect",
};

/// The slopes STEP and SIN2. A build without any other language than ISG's always has them.
pub const SLOPES: Function = Function {
    built: cfg!(any(feature = "slopes", not(feature = "grbl"))),
    needs: "a slope STEP or SIN2 (P-CHAN-00071 = 0, 2) is not in this build; expected the library's feature `slopes`",
};

/// Proof that the build has the slope STEP. A build without STEP has no such value, so the compiler drops
/// code that needs one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepBuilt {
    /// The build has STEP.
    #[cfg(any(feature = "slopes", not(feature = "grbl")))]
    Yes,
}

/// The proof, if the build has STEP.
#[cfg(any(feature = "slopes", not(feature = "grbl")))]
pub const STEP_BUILT: Option<StepBuilt> = Some(StepBuilt::Yes);
/// No proof: the build does not have STEP.
#[cfg(not(any(feature = "slopes", not(feature = "grbl"))))]
pub const STEP_BUILT: Option<StepBuilt> = None;

/// A constant for a feature, and the message of a build without the feature.
macro_rules! functions {
    ($($(#[$doc:meta])* $constant:ident = $feature:literal: $what:literal;)*) => {$(
        $(#[$doc])*
        pub const $constant: Function = Function {
            built: cfg!(feature = $feature),
            needs: concat!($what, " is not in this build; expected the library's feature `", $feature, "`"),
        };
    )*};
}

functions! {
    /// Contour mode: curves at corners.
    CONTOUR = "contour": "contouring (#CONTOUR MODE, G61, G261, #HSC)";
    /// HSC Surface: one smooth curve through many short blocks.
    SURFACE = "surface": "#HSC [SURFACE]";
    /// Akima splines and B-splines, also those of `#HSC`.
    SPLINES = "splines": "a spline (G151, #SPLINE, #AKIMA, #HSC [BSPLINE], #HSC [OPMODE=2])";
    /// The slope HSC: acceleration may continue from block to block.
    HSC = "hsc": "slope HSC (#SLOPE [TYPE=HSC], P-CHAN-00071 = 3)";
    /// Expressions, P parameters and `$` statements.
    EXPRESSIONS = "expressions": "an expression (P parameters, operators, functions, $ statements)";
    /// FIR filters of the axes (`#FILTER`).
    FILTERS = "filters": "#FILTER";
    /// Axes that move independently of the path.
    BESIDE = "beside": "an axis beside the path ([OSC], [INDP], #WAIT INDP)";
    /// The language of LinuxCNC. For Grbl programs: parameters, O words, subprograms and cycles.
    DIALECTS = "dialects": "the language of LinuxCNC";
}
