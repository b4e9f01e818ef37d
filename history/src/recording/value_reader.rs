//! Reads a MessagePack value into a type.
//!
//! The machine's state has some 700 types. The deserializer of `rmp_serde`, which writes the
//! values, compiles the whole choice of tokens again for each of them: 3 MB of the program.
//! Here one function that is compiled once reads the next token, and a type accepts it or not.

use serde::Deserialize;
use serde::de::value::BorrowedStrDeserializer;
use serde::de::{
    DeserializeSeed, Deserializer, EnumAccess, MapAccess, SeqAccess, VariantAccess, Visitor,
};

/// Deepest nesting of arrays and maps; the machine's state has less than half of it.
const MAX_DEPTH: u32 = 128;
const NIL: u8 = 0xc0;

/// Reads a value that takes all of `bytes`.
///
/// # Errors
/// The bytes are no MessagePack value, more than one, or none of this type.
pub(super) fn read_value<'de, T: Deserialize<'de>>(bytes: &'de [u8]) -> Result<T, ValueError> {
    let mut reader = ValueReader {
        rest: bytes,
        depth: 0,
    };
    let value = T::deserialize(&mut reader)?;
    if reader.rest.is_empty() {
        Ok(value)
    } else {
        Err(ValueError::BytesAfterValue)
    }
}

/// The reason for which bytes are not the expected value.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
pub(super) enum ValueError {
    /// The bytes end within the value.
    #[error("the value is incomplete")]
    Incomplete,
    /// The bytes of a text are not UTF-8.
    #[error("a text is not UTF-8")]
    NotText,
    /// The type does not permit the token here.
    #[error("the token is not expected here")]
    UnexpectedToken,
    /// Arrays and maps are nested deeper than [`MAX_DEPTH`].
    #[error("the value is nested too deeply")]
    TooDeep,
    /// Bytes follow the value.
    #[error("bytes follow the value")]
    BytesAfterValue,
    /// The type to be read refuses the value, for this reason.
    #[error("{0}")]
    Refused(String),
}

impl serde::de::Error for ValueError {
    fn custom<T: core::fmt::Display>(text: T) -> Self {
        Self::Refused(text.to_string())
    }
}

/// A token of MessagePack. The items of an array or a map follow its token.
#[derive(Clone, Copy)]
enum ValueToken<'de> {
    Nil,
    Bool(bool),
    Unsigned(u64),
    Negative(i64),
    Single(f32),
    Double(f64),
    Text(&'de str),
    Bytes(&'de [u8]),
    Array(usize),
    Map(usize),
}

/// The bytes that have not been read, and the current nesting.
struct ValueReader<'de> {
    rest: &'de [u8],
    depth: u32,
}

impl<'de> ValueReader<'de> {
    fn take(&mut self, count: usize) -> Result<&'de [u8], ValueError> {
        let (taken, rest) = self
            .rest
            .split_at_checked(count)
            .ok_or(ValueError::Incomplete)?;
        self.rest = rest;
        Ok(taken)
    }

    /// Reads a big-endian number of `size` bytes.
    fn number(&mut self, size: usize) -> Result<u64, ValueError> {
        let bytes = self.take(size)?;
        Ok(bytes
            .iter()
            .fold(0, |sum, byte| sum << 8 | u64::from(*byte)))
    }

    fn length(&mut self, size: usize) -> Result<usize, ValueError> {
        usize::try_from(self.number(size)?).map_err(|_| ValueError::Incomplete)
    }

    /// Reads a number of `size` bytes in two's complement.
    fn signed(&mut self, size: usize) -> Result<ValueToken<'de>, ValueError> {
        let unused_bits = 64 - 8 * size as u32;
        let value = (self.number(size)? << unused_bits).cast_signed() >> unused_bits;
        Ok(u64::try_from(value).map_or(ValueToken::Negative(value), ValueToken::Unsigned))
    }

    fn text(&mut self, length: usize) -> Result<ValueToken<'de>, ValueError> {
        let text = core::str::from_utf8(self.take(length)?).map_err(|_| ValueError::NotText)?;
        Ok(ValueToken::Text(text))
    }

    /// Reads the next token of the value.
    fn token(&mut self) -> Result<ValueToken<'de>, ValueError> {
        let head = self.number(1)? as u8;
        Ok(match head {
            0x00..=0x7f => ValueToken::Unsigned(u64::from(head)),
            0x80..=0x8f => ValueToken::Map(usize::from(head & 0x0f)),
            0x90..=0x9f => ValueToken::Array(usize::from(head & 0x0f)),
            0xa0..=0xbf => self.text(usize::from(head & 0x1f))?,
            NIL => ValueToken::Nil,
            0xc2 => ValueToken::Bool(false),
            0xc3 => ValueToken::Bool(true),
            0xc4..=0xc6 => {
                let length = self.length(1 << (head - 0xc4))?;
                ValueToken::Bytes(self.take(length)?)
            }
            0xca => ValueToken::Single(f32::from_bits(self.number(4)? as u32)),
            0xcb => ValueToken::Double(f64::from_bits(self.number(8)?)),
            0xcc..=0xcf => ValueToken::Unsigned(self.number(1 << (head - 0xcc))?),
            0xd0..=0xd3 => self.signed(1 << (head - 0xd0))?,
            0xd9..=0xdb => {
                let length = self.length(1 << (head - 0xd9))?;
                self.text(length)?
            }
            0xdc | 0xdd => ValueToken::Array(self.length(2 << (head - 0xdc))?),
            0xde | 0xdf => ValueToken::Map(self.length(2 << (head - 0xde))?),
            0xe0..=0xff => ValueToken::Negative(i64::from(head.cast_signed())),
            // 0xc1 has no meaning, and the texts of extensions have been restored.
            _ => return Err(ValueError::UnexpectedToken),
        })
    }

    /// Reads past a value with all its items.
    fn skip(&mut self) -> Result<(), ValueError> {
        let mut values: usize = 1;
        while values > 0 {
            let items = match self.token()? {
                ValueToken::Array(items) => items,
                ValueToken::Map(entries) => entries.saturating_mul(2),
                _ => 0,
            };
            values = (values - 1).saturating_add(items);
        }
        Ok(())
    }

    /// Lets `visit` read the items of an array or the entries of a map: all of them.
    fn visit_items<T>(
        &mut self,
        count: usize,
        visit: impl FnOnce(&mut Items<'_, 'de>) -> Result<T, ValueError>,
    ) -> Result<T, ValueError> {
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            return Err(ValueError::TooDeep);
        }
        let mut items = Items {
            reader: self,
            left: count,
        };
        let value = visit(&mut items)?;
        if items.left > 0 {
            return Err(ValueError::UnexpectedToken);
        }
        self.depth -= 1;
        Ok(value)
    }
}

/// Expands to methods that read one token of the listed kinds.
macro_rules! one_token {
    ($($method:ident: $($token:pat => $visit:expr),+;)+) => {
        $(fn $method<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ValueError> {
            match self.token()? {
                $($token => $visit(visitor),)+
                _ => Err(ValueError::UnexpectedToken),
            }
        })+
    };
}

/// Expands to methods that read the same as another.
macro_rules! same_token {
    ($($method:ident as $other:ident,)+) => {
        $(fn $method<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ValueError> {
            self.$other(visitor)
        })+
    };
}

impl<'de> Deserializer<'de> for &mut ValueReader<'de> {
    type Error = ValueError;

    fn is_human_readable(&self) -> bool {
        false
    }

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ValueError> {
        match self.token()? {
            ValueToken::Nil => visitor.visit_unit(),
            ValueToken::Bool(value) => visitor.visit_bool(value),
            ValueToken::Unsigned(value) => visitor.visit_u64(value),
            ValueToken::Negative(value) => visitor.visit_i64(value),
            ValueToken::Single(value) => visitor.visit_f32(value),
            ValueToken::Double(value) => visitor.visit_f64(value),
            ValueToken::Text(text) => visitor.visit_borrowed_str(text),
            ValueToken::Bytes(bytes) => visitor.visit_borrowed_bytes(bytes),
            ValueToken::Array(items) => self.visit_items(items, |items| visitor.visit_seq(items)),
            ValueToken::Map(entries) => self.visit_items(entries, |items| visitor.visit_map(items)),
        }
    }

    one_token! {
        deserialize_bool: ValueToken::Bool(value) => |visitor: V| visitor.visit_bool(value);
        deserialize_u64:
            ValueToken::Unsigned(value) => |visitor: V| visitor.visit_u64(value),
            ValueToken::Negative(value) => |visitor: V| visitor.visit_i64(value);
        deserialize_f64:
            ValueToken::Double(value) => |visitor: V| visitor.visit_f64(value),
            ValueToken::Single(value) => |visitor: V| visitor.visit_f32(value);
        deserialize_str: ValueToken::Text(text) => |visitor: V| visitor.visit_borrowed_str(text);
        deserialize_bytes:
            ValueToken::Bytes(bytes) => |visitor: V| visitor.visit_borrowed_bytes(bytes);
        deserialize_unit: ValueToken::Nil => |visitor: V| visitor.visit_unit();
    }

    same_token! {
        deserialize_u8 as deserialize_u64,
        deserialize_u16 as deserialize_u64,
        deserialize_u32 as deserialize_u64,
        deserialize_i8 as deserialize_u64,
        deserialize_i16 as deserialize_u64,
        deserialize_i32 as deserialize_u64,
        deserialize_i64 as deserialize_u64,
        deserialize_f32 as deserialize_f64,
        deserialize_char as deserialize_str,
        deserialize_string as deserialize_str,
        deserialize_identifier as deserialize_str,
        deserialize_byte_buf as deserialize_bytes,
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ValueError> {
        if self.rest.first() == Some(&NIL) {
            self.take(1)?;
            visitor.visit_none()
        } else {
            visitor.visit_some(self)
        }
    }

    fn deserialize_unit_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        visitor: V,
    ) -> Result<V::Value, ValueError> {
        match self.token()? {
            ValueToken::Array(0) => visitor.visit_unit(),
            _ => Err(ValueError::UnexpectedToken),
        }
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        visitor: V,
    ) -> Result<V::Value, ValueError> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ValueError> {
        match self.token()? {
            ValueToken::Array(items) => self.visit_items(items, |items| visitor.visit_seq(items)),
            _ => Err(ValueError::UnexpectedToken),
        }
    }

    fn deserialize_tuple<V: Visitor<'de>>(
        self,
        _length: usize,
        visitor: V,
    ) -> Result<V::Value, ValueError> {
        self.deserialize_seq(visitor)
    }

    fn deserialize_tuple_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        _length: usize,
        visitor: V,
    ) -> Result<V::Value, ValueError> {
        self.deserialize_seq(visitor)
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ValueError> {
        match self.token()? {
            ValueToken::Map(entries) => self.visit_items(entries, |items| visitor.visit_map(items)),
            _ => Err(ValueError::UnexpectedToken),
        }
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        _fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, ValueError> {
        self.deserialize_map(visitor)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _name: &'static str,
        _variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, ValueError> {
        match self.token()? {
            ValueToken::Text(name) => visitor.visit_enum(BorrowedStrDeserializer::new(name)),
            ValueToken::Map(1) => self.visit_items(1, |items| {
                items.left = 0;
                visitor.visit_enum(VariantReader(items.reader))
            }),
            _ => Err(ValueError::UnexpectedToken),
        }
    }

    fn deserialize_ignored_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ValueError> {
        self.skip()?;
        visitor.visit_unit()
    }
}

/// The items of an array, or the entries of a map, that have not been read.
struct Items<'a, 'de> {
    reader: &'a mut ValueReader<'de>,
    left: usize,
}

impl Items<'_, '_> {
    /// Counts an item; `false` after the last.
    const fn next(&mut self) -> bool {
        let is_left = self.left > 0;
        self.left -= is_left as usize;
        is_left
    }

    /// An upper limit of what can follow: a damaged length reserves no memory.
    fn most(&self) -> usize {
        self.left.min(self.reader.rest.len())
    }
}

impl<'de> SeqAccess<'de> for &mut Items<'_, 'de> {
    type Error = ValueError;

    fn next_element_seed<T: DeserializeSeed<'de>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, ValueError> {
        if self.next() {
            seed.deserialize(&mut *self.reader).map(Some)
        } else {
            Ok(None)
        }
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.most())
    }
}

impl<'de> MapAccess<'de> for &mut Items<'_, 'de> {
    type Error = ValueError;

    fn next_key_seed<K: DeserializeSeed<'de>>(
        &mut self,
        seed: K,
    ) -> Result<Option<K::Value>, ValueError> {
        SeqAccess::next_element_seed(self, seed)
    }

    fn next_value_seed<T: DeserializeSeed<'de>>(
        &mut self,
        seed: T,
    ) -> Result<T::Value, ValueError> {
        seed.deserialize(&mut *self.reader)
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.most())
    }
}

/// The name of a variant, and its content.
struct VariantReader<'a, 'de>(&'a mut ValueReader<'de>);

impl<'de> EnumAccess<'de> for VariantReader<'_, 'de> {
    type Error = ValueError;
    type Variant = Self;

    fn variant_seed<T: DeserializeSeed<'de>>(
        self,
        seed: T,
    ) -> Result<(T::Value, Self), ValueError> {
        let variant = seed.deserialize(&mut *self.0)?;
        Ok((variant, self))
    }
}

impl<'de> VariantAccess<'de> for VariantReader<'_, 'de> {
    type Error = ValueError;

    fn unit_variant(self) -> Result<(), ValueError> {
        // A variant without content is a text.
        Err(ValueError::UnexpectedToken)
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(
        self,
        seed: T,
    ) -> Result<T::Value, ValueError> {
        seed.deserialize(self.0)
    }

    fn tuple_variant<V: Visitor<'de>>(
        self,
        _length: usize,
        visitor: V,
    ) -> Result<V::Value, ValueError> {
        self.0.deserialize_seq(visitor)
    }

    fn struct_variant<V: Visitor<'de>>(
        self,
        _fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, ValueError> {
        self.0.deserialize_map(visitor)
    }
}

#[cfg(test)]
mod tests;
