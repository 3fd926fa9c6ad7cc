"""A small compiler: functions of numbers, arrays and tuples, from Python's syntax tree to LLVM.

A first run must not wait for a compiler. What compiled functions need of Python is little (loops,
arithmetic, arrays that are indexed and cut, tuples), and translated at once it takes LLVM a tenth
of a second for a function with all that it calls. Results are those of IEEE 754 in the order that
is written: no fast-math, no contraction, so they depend on no machine's vector width.
"""
