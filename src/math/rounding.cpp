// Refuses to be compiled where numbers are not rounded as the library's margins and exact arithmetic suppose.

#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__ != 0) || \
    defined(__ASSOCIATIVE_MATH__) || defined(__RECIPROCAL_MATH__)
#error "Sightline cannot be compiled with -ffast-math, nor with a part of it"
#endif

#if defined(__FLT_EVAL_METHOD__)
static_assert(
    __FLT_EVAL_METHOD__ == 0 || __FLT_EVAL_METHOD__ >= 16,
    "Sightline cannot be compiled for a processor that calculates in wider types than the code has");
#endif
