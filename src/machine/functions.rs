//! Functions that a build may leave out. Each function is a Cargo feature; all but the last four are on by default.
//!
//! Programs and machine data that need a missing function are refused with its name. Words that switch the function off are
//! accepted. The code tests one of these constants where a function starts, so that the linker drops the rest.
//!
//! | feature | commands | without it |
//! |---|---|---|
//! | `contour` | G61, G261, `#CONTOUR MODE`, `#HSC` | blocks end at their programmed points |
//! | `surface` (needs `contour` and `hsc`) | `#HSC [SURFACE]` | |
//! | `splines` (needs `contour` and `hsc`) | G151, `#SPLINE`, `#AKIMA`, `#HSC [BSPLINE]`, `#HSC [OPMODE=2]` | |
//! | `hsc` | the slope HSC: `#SLOPE [TYPE=HSC]`, P-CHAN-00071 = 3 | |
//! | `expressions` | `P` parameters, operators and functions, `$` statements | words have plain numbers; subroutines stay |
//! | `filters` | `#FILTER`, P-AXIS-00586 | |
//! | `beside` | `[OSC …]`, `[INDP …]`, `#WAIT INDP` | |
//! | `dialects` (off by default) | the words of LinuxCNC and Grbl | programs are ISG's |
//! | `fanuc` (off by default, needs `dialects`) | the words of Fanuc's controllers | |
//! | `kinematics` (off by default, needs `hsc`) | `#KIN ID`, `#TRAFO` | |
//! | `plc` (off by default) | `#CONTOUR LOOKAHEAD LOG`, `#DISTANCE PROG START CLEAR`, `#RT WHILE`, `#FLUSH`, `V.` variables | |
//!
//! The feature `fast` is no function: with it the compiler copies more functions into their callers, and the table of sines
//! is larger. Set points are the same bits with and without `fast`.

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

    /// `count` if the function is compiled in, else 0: the size of memory that only this function needs.
    pub const fn room(self, count: usize) -> usize {
        if self.built { count } else { 0 }
    }

    /// Checks that the function is compiled in.
    ///
    /// # Errors
    /// The function is missing: its name and what to do.
    #[inline(always)]
    pub const fn check(self) -> Result<(), &'static str> {
        if self.built { Ok(()) } else { Err(self.needs) }
    }
}

/// Whether this is a small build: one without Surface and splines. It has less room in the queue.
pub const IS_SMALL: bool = !SURFACE.is_built() && !SPLINES.is_built();

/// A constant for a feature, and what is said where it is off.
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
    /// Corners of contour mode.
    CONTOUR = "contour": "contouring (#CONTOUR MODE, G61, G261, #HSC)";
    /// HSC Surface.
    SURFACE = "surface": "#HSC [SURFACE]";
    /// Akima and B-splines, those of #HSC too.
    SPLINES = "splines": "a spline (G151, #SPLINE, #AKIMA, #HSC [BSPLINE], #HSC [OPMODE=2])";
    /// The slope HSC.
    HSC = "hsc": "slope HSC (#SLOPE [TYPE=HSC], P-CHAN-00071 = 3)";
    /// Expressions, P parameters and `$` statements.
    EXPRESSIONS = "expressions": "an expression (P parameters, operators, functions, $ statements)";
    /// Filters of the axes.
    FILTERS = "filters": "#FILTER";
    /// Axes that move independently of the path.
    BESIDE = "beside": "an axis beside the path ([OSC], [INDP], #WAIT INDP)";
}
