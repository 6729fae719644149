//! Which functions are compiled in: each is a feature of the crate, and all of them are on by default.
//!
//! A function that is left out is one that is not enabled at start-up: a program or machine data that ask for it
//! are refused by its name; what switches it off is accepted. Where it would begin is a question to one of these
//! constants, so that nothing of it is linked.
//!
//! | feature | commands | without it |
//! |---|---|---|
//! | `contour` | G61, G261, `#CONTOUR MODE`, `#HSC` | blocks end where they were programmed to |
//! | `surface` | `#HSC [SURFACE]` | needs `contour` |
//! | `splines` | G151, `#SPLINE`, `#AKIMA`, `#HSC [BSPLINE]`, `#HSC [OPMODE=2]` | needs `contour` |
//! | `hsc` | the slope HSC: `#SLOPE [TYPE=HSC]`, P-CHAN-00071 = 3 | |
//! | `expressions` | `P` parameters, operators and functions, `$` statements | words have numbers, subroutines stay |
//! | `filters` | `#FILTER`, P-AXIS-00586 | |
//! | `beside` | `[OSC …]`, `[INDP …]`, `#WAIT INDP` | |
//! | `dialects` (off by default) | the words of LinuxCNC and Grbl | programs are ISG's |
//! | `plc` (off by default) | `#CONTOUR LOOKAHEAD LOG`, `#DISTANCE PROG START CLEAR` | they are refused |
//!
//! The feature `fast` is none of them: without it what the planner calls is called and not copied, and the sine has
//! a smaller table. Programs are accepted and refused as with it, and have the same bits.

/// A function that may be left out of a build.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Function {
    built: bool,
    needs: &'static str,
}

impl Function {
    /// Whether it is compiled in.
    #[inline(always)]
    pub const fn is_built(self) -> bool {
        self.built
    }

    /// Room for `count` of what only it needs.
    pub const fn room(self, count: usize) -> usize {
        if self.built { count } else { 0 }
    }

    /// That it is compiled in.
    ///
    /// # Errors
    /// Its name and what to do: it is not.
    #[inline(always)]
    pub const fn check(self) -> Result<(), &'static str> {
        if self.built { Ok(()) } else { Err(self.needs) }
    }
}

/// A build without Surface and splines is one for little memory: where what is seldom needed takes much of it, it
/// has less.
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
    /// Axes that move beside the path.
    BESIDE = "beside": "an axis beside the path ([OSC], [INDP], #WAIT INDP)";
}
