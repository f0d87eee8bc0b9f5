//! Names of keys and columns in words, for people: `elapsed_s` is `elapsed [s]`.

/// Endings of keys that are units, and the units as they are printed. A long ending comes before a shorter one that it
/// ends with (`_um_per_n` before `_n`).
const UNITS: [(&str, &str); 20] = [
    ("_n_per_m", "N/m"),
    ("_kg_per_m", "kg/m"),
    ("_um_per_n", "µm/N"),
    ("_m_per_n", "m/N"),
    ("_nm_per_rad", "N m/rad"),
    ("_kgm2", "kg m²"),
    ("_knm2", "kN m²"),
    ("_percent", "%"),
    ("_rpm", "rpm"),
    ("_deg", "°"),
    ("_eur", "EUR"),
    ("_mm", "mm"),
    ("_cm", "cm"),
    ("_hz", "Hz"),
    ("_kg", "kg"),
    ("_nm", "N m"),
    ("_pa", "Pa"),
    ("_m", "m"),
    ("_n", "N"),
    ("_s", "s"),
];

/// The words for keys whose own name says too little.
const OWN_WORDS: [(&str, &str); 6] = [
    ("designs_per_s", "designs evaluated per s"),
    ("hypervolume", "hypervolume of the front [no unit: of logarithms]"),
    ("ballast_designs", "designs that are on the front only by extra weight"),
    ("effects_mass_kg", "mass that effects add [kg]"),
    ("designs_total", "designs in all"),
    ("boxes_open", "boxes left open"),
];

/// The name of a key or column in words, with its unit in brackets.
pub(crate) fn key_words(key: &str) -> String {
    if let Some((_, words)) = OWN_WORDS.iter().find(|(own, _)| *own == key) {
        return (*words).to_string();
    }
    let with_unit = UNITS.iter().find_map(|(ending, unit)| {
        let name = key.strip_suffix(ending).filter(|name| !name.is_empty())?;
        Some(format!("{} [{unit}]", name.replace('_', " ")))
    });
    with_unit.unwrap_or_else(|| key.replace('_', " "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_is_words_with_its_unit() {
        assert_eq!(key_words("elapsed_s"), "elapsed [s]");
        assert_eq!(key_words("weight_per_length_n_per_m"), "weight per length [N/m]");
        assert_eq!(key_words("front_size"), "front size");
        assert_eq!(key_words("designs_per_s"), "designs evaluated per s");
        assert!(key_words("hypervolume").contains("no unit"));
    }
}
