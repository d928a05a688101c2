//! Every kernel, once: over which arguments, how it is computed, what is true, and how far from it it may be.
//!
//! To add a kernel is to add one `kernel!` to the list of its family; tests and bench follow.

#[macro_use]
mod row;

pub(crate) mod axes;
pub(crate) mod big;
mod facets;
mod fresnel;
mod geometry;
mod matt;
mod phong;
#[path = "../../support/random.rs"]
pub(crate) mod random;
mod reference;
mod specular;
mod spherical;
mod vectors;
mod warps;

pub(crate) use row::Row;

/// All kernels, by family.
pub(crate) fn rows() -> Vec<Row> {
    let surfaces = [fresnel::rows(), specular::rows(), matt::rows(), facets::rows(), phong::rows()];
    let others = [warps::rows(), spherical::rows(), vectors::rows(), geometry::rows()];
    surfaces.into_iter().chain(others).flatten().collect()
}
