//! Factory values from the table of parameters.

use std::fmt::Write as _;

/// Titles of the columns with the factory values, in the order of the list.
const COLUMNS: [&str; 4] = ["factory_n0", "factory_n2", "factory_n3", "factory_n4"];

/// Range of a state parameter, whose values are written as eight bits.
const STATE_RANGE: &str = "00000000..11111111";

/// Returns the source with the factory values of all whole parameters.
///
/// # Errors
///
/// Returns the fault of the table, with the line.
pub fn generate(table: &str) -> Result<String, String> {
    let mut lines = table.lines();
    let heading: Vec<&str> = lines.next().unwrap_or_default().split('\t').collect();
    let column = |name: &str| {
        let place = heading.iter().position(|title| *title == name);
        place.ok_or_else(|| format!("no column {name}"))
    };
    let (number, bit, range) = (column("number")?, column("bit")?, column("range")?);
    let mut source = String::from(
        "//! Factory values, written by `cargo xtask tables`: a control that starts does not read \
         the\n//! whole table for them.\n\n/// Number of each parameter, and its values on the disks \
         N0 (and N1), N2, N3, N4.\npub(super) const FACTORY_VALUES: &[(u16, [i32; 4])] = &[\n",
    );
    for line in lines {
        let fields: Vec<&str> = line.split('\t').collect();
        let field = |place: usize| fields.get(place).copied().unwrap_or_default();
        if field(bit) != "-" {
            continue;
        }
        let radix = if field(range) == STATE_RANGE { 2 } else { 10 };
        let mut values = Vec::new();
        for name in COLUMNS {
            values.push(parse(field(column(name)?), radix, line)?.to_string());
        }
        let number = parse(field(number), 10, line)?;
        // Writing to a string cannot fail.
        let _ = writeln!(source, "    ({number}, [{}]),", values.join(", "));
    }
    source.push_str("];\n");
    Ok(source)
}

fn parse(number: &str, radix: u32, line: &str) -> Result<i32, String> {
    let parsed = i32::from_str_radix(number, radix);
    parsed.map_err(|_| format!("{number:?} is not a number: {line}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADING: &str = "number\tbit\trange\tfactory_n0\tfactory_n2\tfactory_n3\tfactory_n4\n";

    #[test]
    fn whole_parameters_have_their_values_in_decimal() {
        let rows = "003\t-\t00000000..11111111\t00110000\t1\t10\t11\n\
                    003\t5\t0..1\t1\t0\t1\t1\n022\t-\t6..15000\t3800\t4000\t-5\t3000\n";
        let source = generate(&format!("{HEADING}{rows}")).unwrap();
        let values: Vec<&str> = source.lines().filter(|line| line.contains("[")).collect();
        assert_eq!(
            values[1..],
            [
                "    (3, [48, 1, 2, 3]),",
                "    (22, [3800, 4000, -5, 3000]),"
            ]
        );
    }

    #[test]
    fn a_fault_has_its_line() {
        let row = "022\t-\t6..15000\t3800\tx\t1\t1";
        let fault = generate(&format!("{HEADING}{row}\n")).unwrap_err();
        assert!(fault.contains(row), "{fault}");
    }
}
