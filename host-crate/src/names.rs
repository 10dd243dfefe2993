//! Enums whose values have names.

/// A name that no value of an enum has.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no '{name}'; there are: {known}")]
pub struct UnknownName {
    /// What was asked for.
    pub name: String,
    /// What there is.
    pub known: String,
}

/// Gives each value of an enum its name: for headers of pictures, for reports, and for whoever
/// lets a person choose.
macro_rules! named {
    ($kind:ident { $($value:ident: $name:literal,)+ }) => {
        impl $kind {
            /// Every value.
            pub const ALL: &'static [Self] = &[$(Self::$value),+];

            /// The name of the value.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$value => $name,)+
                }
            }
        }

        impl ::std::fmt::Display for $kind {
            fn fmt(&self, f: &mut ::std::fmt::Formatter<'_>) -> ::std::fmt::Result {
                f.pad(self.name())
            }
        }

        impl ::std::str::FromStr for $kind {
            type Err = $crate::names::UnknownName;

            fn from_str(name: &str) -> Result<Self, Self::Err> {
                Self::ALL.iter().copied().find(|value| value.name() == name).ok_or_else(|| {
                    $crate::names::UnknownName {
                        name: name.to_owned(),
                        known: Self::ALL
                            .iter()
                            .map(|value| value.name())
                            .collect::<Vec<_>>()
                            .join(", "),
                    }
                })
            }
        }
    };
}

pub(crate) use named;
