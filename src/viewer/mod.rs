//! A run as a page that plays it in three dimensions: what the page is given,
//! the page itself, and the small server that hands both to a browser on this
//! machine. `docs/viewer.md` is the user's guide.

mod data;
mod links;
mod page;
mod redirect;
mod request;
mod server;
mod shapes;

pub use data::{FORMAT, MAGIC, RunData, VERSION, read_run_data};
pub use page::{Site, self_contained};
pub use redirect::Redirect;
pub use request::Responder;
pub use server::{Server, ServerError};
