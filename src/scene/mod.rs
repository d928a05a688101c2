//! From files to a frozen scene.

pub mod description;
pub mod load;
mod record;
pub mod schema;

pub use description::Description;
pub use load::{Loaded, load};
pub use schema::schema;
