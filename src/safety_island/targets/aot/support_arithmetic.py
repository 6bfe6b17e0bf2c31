# SPDX-License-Identifier: Apache-2.0
"""64-bit arithmetic for 32-bit Arm, in LLVM IR, under the names that compilers call it by.

Run-time ABI for the Arm Architecture (IHI 0043), section 4. Its calling convention
(``arm_aapcscc``) passes floating point in integer registers, whatever the rest of a program does.
"""

from __future__ import annotations

_DIVIDE = """
define internal { i64, i64 } @support.divide(i64 %n, i64 %d) {
entry:
  %either = or i64 %n, %d
  %high = lshr i64 %either, 32
  %is_narrow = icmp eq i64 %high, 0
  %is_zero = icmp eq i64 %d, 0
  %is_less = icmp ult i64 %n, %d
  %is_done = or i1 %is_zero, %is_less
  br i1 %is_done, label %done, label %choose
choose:
  br i1 %is_narrow, label %narrow, label %wide
narrow:
  %n32 = trunc i64 %n to i32
  %d32 = trunc i64 %d to i32
  %q32 = udiv i32 %n32, %d32
  %r32 = urem i32 %n32, %d32
  %qn = zext i32 %q32 to i64
  %rn = zext i32 %r32 to i64
  br label %done
wide:
  %zeros_n = call i64 @llvm.ctlz.i64(i64 %n, i1 false)
  %zeros_d = call i64 @llvm.ctlz.i64(i64 %d, i1 false)
  %first = sub i64 %zeros_d, %zeros_n
  br label %step
step:
  %k = phi i64 [ %first, %wide ], [ %k_next, %step ]
  %q = phi i64 [ 0, %wide ], [ %q_next, %step ]
  %r = phi i64 [ %n, %wide ], [ %r_next, %step ]
  %part = shl i64 %d, %k
  %fits = icmp uge i64 %r, %part
  %bit = shl i64 1, %k
  %q_more = or i64 %q, %bit
  %r_less = sub i64 %r, %part
  %q_next = select i1 %fits, i64 %q_more, i64 %q
  %r_next = select i1 %fits, i64 %r_less, i64 %r
  %k_next = sub i64 %k, 1
  %is_last = icmp eq i64 %k, 0
  br i1 %is_last, label %done, label %step
done:
  %quotient = phi i64 [ 0, %entry ], [ %qn, %narrow ], [ %q_next, %step ]
  %remainder = phi i64 [ %n, %entry ], [ %rn, %narrow ], [ %r_next, %step ]
  %pair = insertvalue { i64, i64 } undef, i64 %quotient, 0
  %result = insertvalue { i64, i64 } %pair, i64 %remainder, 1
  ret { i64, i64 } %result
}
declare i64 @llvm.ctlz.i64(i64, i1)
"""
"""Unsigned quotient and remainder; division by zero gives 0 and the dividend."""

_UNSIGNED = """
define arm_aapcscc { i64, i64 } @__aeabi_uldivmod(i64 %n, i64 %d) {
  %both = call { i64, i64 } @support.divide(i64 %n, i64 %d)
  ret { i64, i64 } %both
}
"""

_SIGNED = """
define arm_aapcscc { i64, i64 } @__aeabi_ldivmod(i64 %n, i64 %d) {
  %sign_n = ashr i64 %n, 63
  %sign_d = ashr i64 %d, 63
  %flipped_n = xor i64 %n, %sign_n
  %flipped_d = xor i64 %d, %sign_d
  %size_n = sub i64 %flipped_n, %sign_n
  %size_d = sub i64 %flipped_d, %sign_d
  %both = call { i64, i64 } @support.divide(i64 %size_n, i64 %size_d)
  %size_q = extractvalue { i64, i64 } %both, 0
  %size_r = extractvalue { i64, i64 } %both, 1
  %sign_q = xor i64 %sign_n, %sign_d
  %flipped_q = xor i64 %size_q, %sign_q
  %flipped_r = xor i64 %size_r, %sign_n
  %quotient = sub i64 %flipped_q, %sign_q
  %remainder = sub i64 %flipped_r, %sign_n
  %pair = insertvalue { i64, i64 } undef, i64 %quotient, 0
  %result = insertvalue { i64, i64 } %pair, i64 %remainder, 1
  ret { i64, i64 } %result
}
"""


def _to_double(name: str, high_to_double: str) -> str:
    """Both halves are exact, so the sum is rounded once."""
    return f"""
define arm_aapcscc double @{name}(i64 %x) {{
  %upper = ashr i64 %x, 32
  %high = trunc i64 %upper to i32
  %low = trunc i64 %x to i32
  %h = {high_to_double} i32 %high to double
  %l = uitofp i32 %low to double
  %scaled = fmul double %h, 4294967296.0
  %sum = fadd double %scaled, %l
  ret double %sum
}}
"""


_TO_INTEGER = """
define arm_aapcscc i64 @__aeabi_d2lz(double %x) {
entry:
  %size = call double @llvm.fabs.f64(double %x)
  %is_inside = fcmp olt double %size, 9223372036854775808.0
  br i1 %is_inside, label %inside, label %outside
inside:
  %shifted = fmul double %size, 0x3DF0000000000000
  %high = fptoui double %shifted to i32
  %h = uitofp i32 %high to double
  %whole = fmul double %h, 4294967296.0
  %rest = fsub double %size, %whole
  %low = fptoui double %rest to i32
  %h64 = zext i32 %high to i64
  %l64 = zext i32 %low to i64
  %upper = shl i64 %h64, 32
  %sum = or i64 %upper, %l64
  %negated = sub i64 0, %sum
  %is_negative = fcmp olt double %x, 0.0
  %result = select i1 %is_negative, i64 %negated, i64 %sum
  ret i64 %result
outside:
  ret i64 -9223372036854775808
}
declare double @llvm.fabs.f64(double)
"""
"""Towards zero; beyond the range, and for NaN, the least integer, as x86 has it."""

ARITHMETIC = {
    "__aeabi_uldivmod": _UNSIGNED + _DIVIDE,
    "__aeabi_ldivmod": _SIGNED + _DIVIDE,
    "__aeabi_l2d": _to_double("__aeabi_l2d", "sitofp"),
    "__aeabi_ul2d": _to_double("__aeabi_ul2d", "uitofp"),
    "__aeabi_d2lz": _TO_INTEGER,
}
