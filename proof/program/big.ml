(* SPDX-License-Identifier: BSD-3-Clause *)
(* Coq's integers by zarith's: each function is what Coq's of that name is, for all arguments, where it returns. Products
   are counted, and those beyond the limit are refused: a checker that does not return accepts nothing. *)
type t = Z.t

exception Limit
let left = ref max_int

let zero = Z.zero
let one = Z.one
let same p = p
let double p = Z.shift_left p 1
let double_one p = Z.succ (Z.shift_left p 1)
let case_positive odd even one p =
  if Z.equal p Z.one then one () else if Z.is_odd p then odd (Z.shift_right p 1) else even (Z.shift_right p 1)
let case_z zero pos neg x =
  let s = Z.sign x in
  if s = 0 then zero () else if s > 0 then pos x else neg (Z.neg x)

let add = Z.add
let sub = Z.sub
let mul a b =
  decr left;
  if !left < 0 then raise Limit;
  Z.mul a b
let neg = Z.neg
let abs = Z.abs
let max = Z.max
let min = Z.min
let sgn x = Z.of_int (Z.sign x)
let equal = Z.equal
let leb = Z.leq
let ltb = Z.lt
let of_int = Z.of_int
let to_nat x = if Z.sign x <= 0 then 0 else Z.to_int x

(* Rounded down; by 0 it is 0. *)
let div a b = if Z.sign b = 0 then Z.zero else Z.fdiv a b

(* Both round down; a negative count shifts the other way. *)
let shift a k = if k >= 0 then Z.shift_left a k else Z.shift_right a (-k)
let shiftl a k = shift a (Z.to_int k)
let shiftr a k = shift a (-(Z.to_int k))
let pow a k = if Z.sign k < 0 then Z.zero else Z.pow a (Z.to_int k)

(* Of what is not positive: 0. *)
let sqrt a = if Z.sign a <= 0 then Z.zero else Z.sqrt a
let sqrt_up a =
  if Z.sign a <= 0 then Z.zero
  else
    let r = Z.sqrt a in
    if Z.equal (Z.mul r r) a then r else Z.succ r
let log2 a = if Z.sign a <= 0 then Z.zero else Z.of_int (Z.numbits a - 1)
