//! A camera's path in a file: one line a frame.

use std::fs;
use std::path::Path;

use anyhow::{Context, anyhow, bail, ensure};
use glam::Vec3;
use tercet::worlds::Pose;

/// The columns, in order. They may stand in the first line, as a header.
const COLUMNS: [&str; 7] = ["eye_x", "eye_y", "eye_z", "target_x", "target_y", "target_z", "fov_y_degrees"];

/// Reads a path. Empty lines and those that begin with # are passed over.
///
/// # Errors
/// Naming the file and the line: not seven numbers, a field of view that is none, a target at the
/// eye; or a file without a frame.
pub(crate) fn read(file: &Path) -> anyhow::Result<Vec<Pose>> {
    let text = fs::read_to_string(file).with_context(|| format!("cannot read {}", file.display()))?;
    parse(&text).map_err(|why| anyhow!("{}, {why:#}", file.display()))
}

fn parse(text: &str) -> anyhow::Result<Vec<Pose>> {
    let mut poses = Vec::new();
    let mut header_may_come = true;
    for (n, line) in text.trim_start_matches('\u{feff}').lines().enumerate() {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let fields: Vec<&str> = line.split(',').map(str::trim).collect();
        if !(std::mem::take(&mut header_may_come) && fields == COLUMNS) {
            poses.push(pose(&fields).with_context(|| format!("line {}", n + 1))?);
        }
    }
    ensure!(!poses.is_empty(), "which has no line with a frame");
    Ok(poses)
}

fn pose(fields: &[&str]) -> anyhow::Result<Pose> {
    ensure!(
        fields.len() == COLUMNS.len(),
        "{} fields instead of {}: write {}",
        fields.len(),
        COLUMNS.len(),
        COLUMNS.join(",")
    );
    let mut numbers = [0.0; COLUMNS.len()];
    for ((number, field), column) in numbers.iter_mut().zip(fields).zip(COLUMNS) {
        *number = match field.parse() {
            Ok(x) if f32::is_finite(x) => x,
            _ => bail!("{column} is {field:?}, not a number"),
        };
    }
    let [ex, ey, ez, tx, ty, tz, fov_y_degrees] = numbers;
    let (eye, target) = (Vec3::new(ex, ey, ez), Vec3::new(tx, ty, tz));
    ensure!(eye != target, "the target is where the eye is: there is no direction to look in");
    ensure!(
        fov_y_degrees > 0.0 && fov_y_degrees < 180.0,
        "fov_y_degrees is {fov_y_degrees}: it must lie between 0 and 180"
    );
    Ok(Pose { eye, target, fov_y_degrees })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_frames_with_or_without_header() {
        let header = COLUMNS.join(",");
        let frames = "# a walk\n\n1,2,3, 4,5,6,60\r\n  -1e1,0,0,0,0,0,0.5 \n";
        let plain = parse(frames).expect("two frames");
        assert_eq!(plain.len(), 2);
        assert_eq!(
            plain[0],
            Pose { eye: Vec3::new(1., 2., 3.), target: Vec3::new(4., 5., 6.), fov_y_degrees: 60. }
        );
        assert_eq!(plain[1].eye.x, -10.0);
        assert_eq!(parse(&format!("# first\n{header}\n{frames}")).expect("two frames"), plain);
    }

    #[test]
    fn errors_name_the_line() {
        let good = "0,0,0,0,0,1,60\n";
        for (bad, says) in [
            ("0,0,0,0,1,60", "6 fields"),
            ("0,0,0,0,0,1,60,", "8 fields"),
            ("0,0,x,0,0,1,60", "eye_z is \"x\""),
            ("0,0,0,0,NaN,1,60", "target_y is \"NaN\""),
            ("0,0,0,0,0,1,inf", "fov_y_degrees is \"inf\""),
            ("0,0,0,0,0,1,180", "between 0 and 180"),
            ("1,1,1,1,1,1,60", "target is where the eye is"),
            ("eye_x,eye_y,eye_z,target_x,target_y,target_z,fov_y_degrees", "eye_x is \"eye_x\""),
        ] {
            let error = parse(&format!("{good}# between\n{bad}\n{good}")).expect_err(bad);
            let text = format!("{error:#}");
            assert!(text.contains("line 3") && text.contains(says), "{text}");
        }
        assert!(parse("# nothing\n").is_err());
    }
}
