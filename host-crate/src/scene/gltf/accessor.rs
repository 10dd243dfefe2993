//! Numbers out of buffers (glTF 2.0, section 3.6.2).

use super::document::Document;
use crate::scene::error::SceneError;
use gltf::json::accessor::sparse::Sparse;
use gltf::json::accessor::{ComponentType, Type};
use gltf::json::validation::Checked::Valid;

/// How a component is stored.
#[derive(Clone, Copy)]
struct Stored {
    component: ComponentType,
    /// Whether integers stand for shares.
    is_normalised: bool,
}

impl Stored {
    fn bytes(self) -> usize {
        match self.component {
            ComponentType::I8 | ComponentType::U8 => 1,
            ComponentType::I16 | ComponentType::U16 => 2,
            ComponentType::U32 | ComponentType::F32 => 4,
        }
    }

    /// A component as a number (KHR_mesh_quantization has the same formulas).
    fn number(self, bytes: &[u8]) -> f32 {
        let share = |value: f32, most: f32| {
            if self.is_normalised { (value / most).max(-1.0) } else { value }
        };
        match *bytes {
            [a] if self.component == ComponentType::I8 => share(f32::from(a as i8), 127.0),
            [a] => share(f32::from(a), 255.0),
            [a, b] if self.component == ComponentType::I16 => {
                share(f32::from(i16::from_le_bytes([a, b])), 32_767.0)
            }
            [a, b] => share(f32::from(u16::from_le_bytes([a, b])), 65_535.0),
            [a, b, c, d] if self.component == ComponentType::F32 => {
                f32::from_le_bytes([a, b, c, d])
            }
            [a, b, c, d] => u32::from_le_bytes([a, b, c, d]) as f32,
            _ => 0.0,
        }
    }

    /// A component as an index.
    fn index(self, bytes: &[u8]) -> u32 {
        match *bytes {
            [a] => a.into(),
            [a, b] => u16::from_le_bytes([a, b]).into(),
            [a, b, c, d] => u32::from_le_bytes([a, b, c, d]),
            _ => 0,
        }
    }
}

fn components(type_: Type) -> usize {
    match type_ {
        Type::Scalar => 1,
        Type::Vec2 => 2,
        Type::Vec3 => 3,
        Type::Vec4 | Type::Mat2 => 4,
        Type::Mat3 => 9,
        Type::Mat4 => 16,
    }
}

impl Document<'_> {
    /// How many components an accessor's elements have.
    pub(super) fn components(&self, accessor: usize, place: &str) -> Result<usize, SceneError> {
        let found = self.get(&self.root.accessors, accessor, "accessors", place)?;
        match found.type_ {
            Valid(type_) => Ok(components(type_)),
            _ => Err(self.wrong(&format!("accessors[{accessor}].type"), "is none of glTF's")),
        }
    }

    /// The elements of an accessor as numbers; `place` names it.
    pub(super) fn numbers<const N: usize>(
        &self,
        accessor: usize,
        place: &str,
    ) -> Result<Vec<[f32; N]>, SceneError> {
        self.elements(accessor, place, Stored::number)
    }

    /// The elements of an accessor as indices, which are integers without a sign.
    pub(super) fn indices<const N: usize>(
        &self,
        accessor: usize,
        place: &str,
    ) -> Result<Vec<[u32; N]>, SceneError> {
        let found = self.get(&self.root.accessors, accessor, "accessors", place)?;
        let is_integer = |component| {
            matches!(component, ComponentType::U8 | ComponentType::U16 | ComponentType::U32)
        };
        if let Valid(stored) = found.component_type
            && !is_integer(stored.0)
        {
            let what = format!("has signed or real components, but {place} needs indices");
            return Err(self.wrong(&format!("accessors[{accessor}]"), what));
        }
        self.elements(accessor, place, Stored::index)
    }

    fn elements<T: Copy + Default, const N: usize>(
        &self,
        accessor: usize,
        place: &str,
        component: impl Fn(Stored, &[u8]) -> T,
    ) -> Result<Vec<[T; N]>, SceneError> {
        let found = self.get(&self.root.accessors, accessor, "accessors", place)?;
        let here = format!("accessors[{accessor}]");
        let own = self.components(accessor, place)?;
        if own != N {
            let what = format!("has elements of {own} components, but {place} needs {N}");
            return Err(self.wrong(&here, what));
        }
        let Valid(stored) = found.component_type else {
            return Err(self.wrong(&format!("{here}.componentType"), "is none of glTF's"));
        };
        let stored = Stored { component: stored.0, is_normalised: found.normalized };
        let count = usize::try_from(found.count.0)
            .map_err(|_| self.wrong(&format!("{here}.count"), "is too large"))?;
        self.charge((count as u64).saturating_mul(4 * N as u64), &here)?;
        let element = |bytes: &[u8]| -> [T; N] {
            let size = stored.bytes();
            std::array::from_fn(|k| component(stored, &bytes[k * size..(k + 1) * size]))
        };
        let size = N * stored.bytes();
        let mut elements: Vec<[T; N]> = match found.buffer_view {
            Some(view) => {
                let offset = found.byte_offset.unwrap_or_default().0;
                let rows = Rows { view: view.value(), offset, size, count };
                self.rows(&rows, &here)?.map(element).collect()
            }
            None => vec![[T::default(); N]; count],
        };
        if let Some(sparse) = &found.sparse {
            self.replace(&mut elements, sparse, size, &format!("{here}.sparse"), element)?;
        }
        Ok(elements)
    }

    /// Replaces the elements, whose rows have `size` bytes, that are stored apart.
    fn replace<T>(
        &self,
        elements: &mut [T],
        sparse: &Sparse,
        size: usize,
        here: &str,
        element: impl Fn(&[u8]) -> T,
    ) -> Result<(), SceneError> {
        let Valid(kind) = sparse.indices.component_type else {
            return Err(self.wrong(&format!("{here}.indices.componentType"), "is none of glTF's"));
        };
        let kind = Stored { component: kind.0, is_normalised: false };
        let many = usize::try_from(sparse.count.0).unwrap_or(usize::MAX);
        let (indices, values) = (&sparse.indices, &sparse.values);
        let places = Rows {
            view: indices.buffer_view.value(),
            offset: indices.byte_offset.0,
            size: kind.bytes(),
            count: many,
        };
        let others = Rows {
            view: values.buffer_view.value(),
            offset: values.byte_offset.0,
            size,
            count: many,
        };
        let [of_places, of_others] = ["indices", "values"].map(|list| format!("{here}.{list}"));
        let places = self.rows(&places, &of_places)?;
        for (at, value) in places.zip(self.rows(&others, &of_others)?) {
            let at = kind.index(at) as usize;
            let count = elements.len();
            let Some(found) = elements.get_mut(at) else {
                let what = format!("names element {at}, but there are {count}");
                return Err(self.wrong(&of_places, what));
            };
            *found = element(value);
        }
        Ok(())
    }

    /// The bytes of each row.
    fn rows(
        &self,
        &Rows { view, offset, size, count }: &Rows,
        place: &str,
    ) -> Result<impl Iterator<Item = &[u8]>, SceneError> {
        let (bytes, stride) = self.view(view, place)?;
        let stride = stride.unwrap_or(size);
        if stride < size {
            let what = format!("has elements of {size} bytes, but they are {stride} apart");
            return Err(self.wrong(place, what));
        }
        let offset = usize::try_from(offset).unwrap_or(usize::MAX);
        let end = count.checked_sub(1).map_or(Some(0), |last| {
            last.checked_mul(stride)?.checked_add(size)?.checked_add(offset)
        });
        if end.is_none_or(|end| end > bytes.len()) {
            let what = format!(
                "has {count} elements from byte {offset} on, which reach beyond the {} bytes of \
                 bufferViews[{view}]",
                bytes.len()
            );
            return Err(self.wrong(place, what));
        }
        Ok((0..count).map(move |row| &bytes[offset + row * stride..][..size]))
    }
}

/// Elements in a buffer view.
struct Rows {
    view: usize,
    /// Bytes before the first one.
    offset: u64,
    /// Bytes of one.
    size: usize,
    count: usize,
}
