//! Functions of a world that stands before another, for tests of the library and of the program
//! and for the referee.

/// Functions that do what those of a world in a field of `self` do.
macro_rules! handed_on {
    (@ $inner:ident fn $name:ident(&mut self $(, $arg:ident: $kind:ty)*) $(-> $out:ty)?) => {
        fn $name(&mut self $(, $arg: $kind)*) $(-> $out)? {
            self.$inner.$name($($arg),*)
        }
    };
    (@ $inner:ident fn $name:ident(&self $(, $arg:ident: $kind:ty)*) $(-> $out:ty)?) => {
        fn $name(&self $(, $arg: $kind)*) $(-> $out)? {
            self.$inner.$name($($arg),*)
        }
    };
    ($inner:ident: $(fn $name:ident $given:tt $(-> $out:ty)?;)+) => {
        $(handed_on!(@ $inner fn $name $given $(-> $out)?);)+
    };
}
