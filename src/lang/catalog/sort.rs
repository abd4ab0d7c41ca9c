//! `sort`: piece by piece, so that it can be cancelled between two.

use super::list::each;
use crate::lang::fault::{Fault, Outcome, Stop};
use crate::lang::ops::pause;
use crate::lang::value::Value;
use crate::lang::word::{Args, Host};
use ecow::EcoVec;
use std::cmp::Ordering;

/// A list in the order of its values, or of those that a function makes of them.
pub fn sort(host: &mut dyn Host, a: &[Value]) -> Outcome {
    let (mut keys, mut items): (Vec<Value>, Vec<Value>) = (Vec::new(), Vec::new());
    each(host, &a[0], |host, item| {
        let key = if a.given(1) { host.call(&a[1], std::slice::from_ref(&item))? } else { item.clone() };
        let like = keys.first().unwrap_or(&key);
        if !matches!(
            (like, &key),
            (Value::Number(_), Value::Number(_))
                | (Value::Angle(_), Value::Angle(_))
                | (Value::Text(_), Value::Text(_))
        ) {
            let fault = match like.kind() == key.kind() {
                true => Fault::new(format!("`sort` can't order {}", key.kind())).note(
                    "it orders numbers, angles or texts; for others give `by:` a function that makes one of them",
                ),
                false => Fault::new(format!("`sort` can't order {} and {}", like.kind(), key.kind())),
            };
            return Err(fault.on(usize::from(a.given(1))).into());
        }
        keys.push(key);
        items.push(item);
        Ok(true)
    })?;
    let mut out = EcoVec::with_capacity(items.len());
    for (i, place) in rising(host, &keys)?.into_iter().enumerate() {
        pause(i, host.build())?;
        out.push(items[place as usize].clone());
    }
    Ok(Value::list(out))
}

/// As many as are sorted in about a millisecond.
const PIECE: usize = 8192;

/// The places of keys in rising order; equal ones keep theirs.
fn rising(host: &mut dyn Host, keys: &[Value]) -> Result<Vec<u32>, Stop> {
    let compare = |i: &u32, j: &u32| compare(&keys[*i as usize], &keys[*j as usize]);
    let mut order: Vec<u32> = (0..keys.len() as u32).collect();
    for piece in order.chunks_mut(PIECE) {
        host.spend(0)?;
        piece.sort_by(compare);
    }
    let mut merged = Vec::with_capacity(order.len());
    let mut sorted = PIECE;
    while sorted < order.len() {
        for pair in order.chunks(2 * sorted) {
            let (mut a, mut b) = pair.split_at(sorted.min(pair.len()));
            while let ([i, rest_a @ ..], [j, rest_b @ ..]) = (a, b) {
                pause(merged.len(), host.build())?;
                if compare(j, i).is_lt() {
                    merged.push(*j);
                    b = rest_b;
                } else {
                    merged.push(*i);
                    a = rest_a;
                }
            }
            merged.extend_from_slice(a);
            merged.extend_from_slice(b);
        }
        std::mem::swap(&mut order, &mut merged);
        merged.clear();
        sorted *= 2;
    }
    Ok(order)
}

/// Numbers are finite, but for the two zeros, which are equal.
fn compare(a: &Value, b: &Value) -> Ordering {
    match (a, b) {
        (Value::Number(x), Value::Number(y)) | (Value::Angle(x), Value::Angle(y)) => {
            x.partial_cmp(y).unwrap_or(Ordering::Equal)
        }
        (Value::Text(x), Value::Text(y)) => x.cmp(y),
        _ => Ordering::Equal,
    }
}
