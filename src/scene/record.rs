//! The macros by which a table of the scene file is declared once.
//!
//! One declaration gives the type.

/// A table: a struct with one field per key.
macro_rules! record {
    (
        $(#[doc = $about:literal])+
        pub struct $Record:ident $(checked by $check:path)? {
            $( $(#[doc = $doc:literal])+ $key:ident : $Type:ty $(= $default:expr)? $(, $rule:ident($($arg:expr),*))* ; )*
            $( ..$rest:ident : $Rest:ty, $rest_doc:literal; )?
        }
    ) => {
        $(#[doc = $about])+
        #[derive(Clone, Debug, PartialEq)]
        pub struct $Record {
            $( $(#[doc = $doc])+ pub $key: $Type, )*
            $( #[doc = $rest_doc] pub $rest: $Rest, )?
        }
    };
}

/// A table of several kinds: an enum with one variant per kind.
macro_rules! tagged {
    (
        $(#[doc = $about:literal])+
        pub enum $Tagged:ident by $selector:ident $(($($selector_arg:expr),*))? $(checked by $check:path)? {
            $(
                $(#[doc = $kind_about:literal])+
                $tag:literal => $Kind:ident {
                    $( $(#[doc = $doc:literal])+ $key:ident : $Type:ty $(= $default:expr)? $(, $rule:ident($($arg:expr),*))* ; )*
                    $( ..$rest:ident : $Rest:ty, $rest_doc:literal; )?
                }
            )+
        }
    ) => {
        $(#[doc = $about])+
        #[derive(Clone, Debug, PartialEq)]
        pub enum $Tagged {
            $(
                $(#[doc = $kind_about])+
                $Kind {
                    $( $(#[doc = $doc])+ $key: $Type, )*
                    $( #[doc = $rest_doc] $rest: $Rest, )?
                },
            )+
        }
    };
}

/// A word out of a few.
macro_rules! choice {
    (
        $(#[doc = $about:literal])+
        pub enum $Choice:ident { $( $(#[doc = $doc:literal])+ $word:literal => $Word:ident, )+ }
    ) => {
        $(#[doc = $about])+
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum $Choice {
            $( $(#[doc = $doc])+ $Word, )+
        }
    };
}

pub(crate) use {choice, record, tagged};
