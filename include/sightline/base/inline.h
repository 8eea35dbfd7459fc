#pragma once

// Marks functions of public headers whose results the compiler's flags could change: they are compiled into
// their caller at any level of optimisation. Of an inline function that is called, the linker keeps one copy
// for the whole program, and that may be the copy of a source which the program compiles with contraction to
// fused multiply-add or with -ffast-math. The library would then calculate as that source does.
#define SIGHTLINE_INLINE [[gnu::always_inline]] inline
