//! Operators of a register type from the intrinsics that carry them out.

macro_rules! arithmetic {
    ($register:ident, $add:ident, $sub:ident, $mul:ident, $div:ident) => {
        arithmetic!(@ $register, Add, add, $add);
        arithmetic!(@ $register, Sub, sub, $sub);
        arithmetic!(@ $register, Mul, mul, $mul);
        arithmetic!(@ $register, Div, div, $div);
    };
    (@ $register:ident, $operator:ident, $method:ident, $intrinsic:ident) => {
        impl std::ops::$operator for $register {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                // SAFETY: registers exist only where `dispatch` has found the instruction set.
                Self(unsafe { $intrinsic(self.0, other.0) })
            }
        }
    };
}
