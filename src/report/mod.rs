//! report
#[derive(Debug, thiserror::Error)]
#[error("x")]
pub struct ReportError;
pub fn run_figures(_: &std::path::Path, _: &crate::record::RunRecord) -> Result<(), ReportError> {
    Ok(())
}
