(* SPDX-License-Identifier: BSD-3-Clause *)
(** * Numbers and Taylor models

    As verify/fixed.h and verify/taylor.h: an integer counts units of 2^-64, and a model (c0, c1, c2, r) stands for a
    quantity over an interval of time, t = centre + half * s with s in [-1, 1]. The relation [holds m s y] says that the
    model allows the value y at s. It speaks of one s only, so that no lemma here needs functions or derivatives. *)
From Coq Require Import Reals ZArith Lia Lra Bool List.
From FclArtic Require Import Statement.
Import ListNotations.
Open Scope R_scope.

Lemma abs_in x a : Rabs x <= a -> - a <= x <= a.
Proof. unfold Rabs. destruct (Rcase_abs x); lra. Qed.

(** ** Fixed point *)

Definition one : Z := (2 ^ 64)%Z.
Definition ulp : R := / IZR one.
Definition V (z : Z) : R := IZR z * ulp.

Lemma ulp_pos : 0 < ulp.
Proof. apply Rinv_0_lt_compat, IZR_lt. reflexivity. Qed.

Lemma ulp_one : ulp * IZR one = 1.
Proof. unfold ulp. apply Rinv_l, not_0_IZR. discriminate. Qed.

Global Opaque ulp.

Lemma V_add a b : V (a + b) = V a + V b.
Proof. unfold V. rewrite plus_IZR. ring. Qed.
Lemma V_sub a b : V (a - b) = V a - V b.
Proof. unfold V. rewrite minus_IZR. ring. Qed.
Lemma V_opp a : V (- a) = - V a.
Proof. unfold V. rewrite opp_IZR. ring. Qed.
Lemma V_abs a : V (Z.abs a) = Rabs (V a).
Proof.
  unfold V. rewrite abs_IZR, Rabs_mult, (Rabs_right ulp); [reflexivity|].
  left. apply ulp_pos.
Qed.
Lemma V_le a b : (a <= b)%Z -> V a <= V b.
Proof. intros H. apply Rmult_le_compat_r; [left; apply ulp_pos | apply IZR_le, H]. Qed.
Lemma V_lt a b : (a < b)%Z -> V a < V b.
Proof. intros H. apply Rmult_lt_compat_r; [apply ulp_pos | apply IZR_lt, H]. Qed.
Lemma V_0 : V 0 = 0.
Proof. unfold V. ring. Qed.
Lemma V_one : V one = 1.
Proof. unfold V. rewrite Rmult_comm. apply ulp_one. Qed.
Lemma V_ulps n : V n = IZR n * ulp.
Proof. reflexivity. Qed.
Lemma V_max a b : V a <= V (Z.max a b) /\ V b <= V (Z.max a b).
Proof. split; apply V_le; lia. Qed.

(** Rounded down, by less than one unit. *)
Lemma floor_div a n : (0 < n)%Z -> IZR (a / n) <= IZR a / IZR n < IZR (a / n) + 1.
Proof.
  intros Hn. assert (Hr : 0 < IZR n) by (apply IZR_lt; exact Hn).
  pose proof (Z.div_mod a n ltac:(lia)) as E. pose proof (Z.mod_pos_bound a n Hn) as B.
  assert (E2 : IZR a = IZR n * IZR (a / n) + IZR (a mod n)) by (rewrite <- mult_IZR, <- plus_IZR; f_equal; exact E).
  assert (B1 : 0 <= IZR (a mod n)) by (apply IZR_le; lia).
  assert (B2 : IZR (a mod n) < IZR n) by (apply IZR_lt; lia).
  rewrite E2. split.
  - apply Rmult_le_reg_r with (IZR n); [exact Hr|]. unfold Rdiv. rewrite Rmult_assoc, Rinv_l by lra. lra.
  - apply Rmult_lt_reg_r with (IZR n); [exact Hr|]. unfold Rdiv. rewrite Rmult_assoc, Rinv_l by lra. lra.
Qed.

Definition mulz (a b : Z) : Z := Z.shiftr (a * b) 64.
Definition mulup (a b : Z) : Z := (mulz a b + 1)%Z.

Lemma mulz_err a b : 0 <= V a * V b - V (mulz a b) <= ulp.
Proof.
  unfold mulz. rewrite Z.shiftr_div_pow2 by lia. change (2 ^ 64)%Z with one.
  destruct (floor_div (a * b) one ltac:(reflexivity)) as [L U].
  assert (E : V a * V b = IZR (a * b) / IZR one * ulp).
  { unfold V. rewrite mult_IZR. unfold Rdiv.
    replace (/ IZR one) with ulp; [ring|].
    apply Rmult_eq_reg_r with (IZR one); [|apply not_0_IZR; discriminate].
    rewrite ulp_one, Rinv_l; [reflexivity | apply not_0_IZR; discriminate]. }
  rewrite E. unfold V. pose proof ulp_pos. split.
  - replace (_ - _) with ((IZR (a * b) / IZR one - IZR (a * b / one)) * ulp) by ring. apply Rmult_le_pos; lra.
  - replace (_ - _) with ((IZR (a * b) / IZR one - IZR (a * b / one)) * ulp) by ring.
    rewrite <- (Rmult_1_l ulp) at 2. apply Rmult_le_compat_r; lra.
Qed.

Lemma mulup_ge a b : V a * V b <= V (mulup a b).
Proof. unfold mulup. rewrite V_add, (V_ulps 1). pose proof (mulz_err a b). lra. Qed.

Lemma mulup_abs x y a b : Rabs x <= V a -> Rabs y <= V b -> Rabs (x * y) <= V (mulup a b).
Proof.
  intros. rewrite Rabs_mult. eapply Rle_trans; [|apply mulup_ge].
  apply Rmult_le_compat; auto using Rabs_pos.
Qed.

Definition divz (a n : Z) : Z := (a / n)%Z.
Lemma divz_err a n : (0 < n)%Z -> 0 <= V a / IZR n - V (divz a n) <= ulp.
Proof.
  intros Hn. destruct (floor_div a n Hn) as [L U]. unfold divz, V. pose proof ulp_pos.
  replace (IZR a * ulp / IZR n) with (IZR a / IZR n * ulp) by (unfold Rdiv; ring). split.
  - replace (_ - _) with ((IZR a / IZR n - IZR (a / n)) * ulp) by ring. apply Rmult_le_pos; lra.
  - replace (_ - _) with ((IZR a / IZR n - IZR (a / n)) * ulp) by ring.
    rewrite <- (Rmult_1_l ulp) at 2. apply Rmult_le_compat_r; lra.
Qed.

(** ** Taylor models of degree 2 *)

Record tm := Tm { c0 : Z; c1 : Z; c2 : Z; rem : Z }.

Definition poly (m : tm) (s : R) := V (c0 m) + V (c1 m) * s + V (c2 m) * (s * s).
Definition holds (m : tm) (s y : R) : Prop := Rabs (y - poly m s) <= V (rem m).

Lemma holds_eq a s x y : x = y -> holds a s x -> holds a s y.
Proof. intros ->. tauto. Qed.

Definition const (c r : Z) := Tm c 0 0 r.
Definition tm_zero := const 0 0.
Definition tm_one := const one 0.

Lemma holds_const c r s y : holds (const c r) s y <-> Rabs (y - V c) <= V r.
Proof. unfold holds, poly, const; cbn. rewrite V_0. replace (V c + 0 * s + 0 * (s * s)) with (V c) by ring. tauto. Qed.

Lemma holds_exact c s : holds (const c 0) s (V c).
Proof. apply holds_const. rewrite V_0. replace (V c - V c) with 0 by ring. rewrite Rabs_R0. lra. Qed.
Lemma holds_zero s : holds tm_zero s 0.
Proof. pose proof (holds_exact 0 s) as H. rewrite V_0 in H. exact H. Qed.
Lemma holds_one s : holds tm_one s 1.
Proof. pose proof (holds_exact one s) as H. rewrite V_one in H. exact H. Qed.

Lemma holds_rem_nonneg m s y : holds m s y -> 0 <= V (rem m).
Proof. intros H. eapply Rle_trans; [apply Rabs_pos | exact H]. Qed.

Definition tm_add (a b : tm) := Tm (c0 a + c0 b) (c1 a + c1 b) (c2 a + c2 b) (rem a + rem b).
Definition tm_sub (a b : tm) := Tm (c0 a - c0 b) (c1 a - c1 b) (c2 a - c2 b) (rem a + rem b).
Definition tm_opp (a : tm) := Tm (- c0 a) (- c1 a) (- c2 a) (rem a).
Definition widen (a : tm) (r : Z) := Tm (c0 a) (c1 a) (c2 a) (rem a + r).

Lemma holds_add a b s x y : holds a s x -> holds b s y -> holds (tm_add a b) s (x + y).
Proof.
  unfold holds, poly, tm_add; cbn. rewrite !V_add. intros Ha Hb.
  match type of Ha with Rabs ?u <= _ => match type of Hb with Rabs ?v <= _ =>
    match goal with |- Rabs ?w <= _ => replace w with (u + v) by ring end end end.
  eapply Rle_trans; [apply Rabs_triang | lra].
Qed.
Lemma holds_opp a s x : holds a s x -> holds (tm_opp a) s (- x).
Proof.
  unfold holds, poly, tm_opp; cbn. rewrite !V_opp. intros Ha.
  match goal with |- Rabs ?w <= _ => replace w with (- (x - (V (c0 a) + V (c1 a) * s + V (c2 a) * (s * s)))) by ring end.
  rewrite Rabs_Ropp. exact Ha.
Qed.
Lemma holds_sub a b s x y : holds a s x -> holds b s y -> holds (tm_sub a b) s (x - y).
Proof.
  intros Ha Hb. pose proof (holds_add _ _ _ _ _ Ha (holds_opp _ _ _ Hb)) as H.
  unfold holds, poly, tm_add, tm_opp, tm_sub in *; cbn in *. rewrite !V_add, !V_opp in H. rewrite !V_sub, V_add.
  match type of H with Rabs ?u <= _ => match goal with |- Rabs ?w <= _ => replace w with u by ring end end. exact H.
Qed.
Lemma holds_widen a r s x y : holds a s x -> Rabs (y - x) <= V r -> holds (widen a r) s y.
Proof.
  unfold holds, poly, widen; cbn. rewrite V_add. intros Ha Hr.
  match type of Ha with Rabs ?u <= _ => match goal with |- Rabs ?w <= _ => replace w with ((y - x) + u) by ring end end.
  eapply Rle_trans; [apply Rabs_triang | lra].
Qed.

(** Bounds of the polynomial and of the quantity. *)
Definition magnitude (a : tm) : Z := (Z.abs (c0 a) + Z.abs (c1 a) + Z.abs (c2 a))%Z.
Definition bound (a : tm) : Z := (magnitude a + rem a)%Z.

Lemma abs_times_le x k : Rabs k <= 1 -> Rabs (x * k) <= Rabs x.
Proof.
  intros H. rewrite Rabs_mult, <- (Rmult_1_r (Rabs x)) at 1. rewrite Rmult_1_r.
  rewrite <- (Rmult_1_r (Rabs x)) at 2. apply Rmult_le_compat_l; [apply Rabs_pos | exact H].
Qed.

Lemma magnitude_ge a s : Rabs s <= 1 -> Rabs (poly a s) <= V (magnitude a).
Proof.
  intros Hs. unfold poly, magnitude. rewrite !V_add, !V_abs.
  assert (Hss : Rabs (s * s) <= 1).
  { rewrite Rabs_mult. rewrite <- (Rmult_1_r 1). apply Rmult_le_compat; auto using Rabs_pos. }
  pose proof (abs_times_le (V (c1 a)) s Hs). pose proof (abs_times_le (V (c2 a)) (s * s) Hss).
  eapply Rle_trans; [apply Rabs_triang|].
  pose proof (Rabs_triang (V (c0 a)) (V (c1 a) * s)). lra.
Qed.
Lemma bound_ge a s x : Rabs s <= 1 -> holds a s x -> Rabs x <= V (bound a).
Proof.
  intros Hs Ha. unfold bound. rewrite V_add. pose proof (magnitude_ge a s Hs).
  replace x with (poly a s + (x - poly a s)) by ring.
  eapply Rle_trans; [apply Rabs_triang|]. unfold holds in Ha. lra.
Qed.

(** *** Product with a constant (c, r): three products are off by one ulp at most each. *)
Definition tm_scale (c r : Z) (a : tm) : tm :=
  Tm (mulz c (c0 a)) (mulz c (c1 a)) (mulz c (c2 a))
     (mulup (Z.abs c + r) (rem a) + (if Z.eqb r 0 then 0 else mulup (magnitude a) r) + 3)%Z.

Lemma rounding s e0 e1 e2 : Rabs s <= 1 -> 0 <= e0 <= ulp -> 0 <= e1 <= ulp -> 0 <= e2 <= ulp ->
  Rabs (e0 + e1 * s + e2 * (s * s)) <= 3 * ulp.
Proof.
  intros Hs H0 H1 H2. apply Rabs_le. apply abs_in in Hs.
  assert (-1 <= s <= 1) by lra. assert (0 <= s * s <= 1) by nra. assert (- ulp <= e1 * s <= ulp) by nra.
  assert (0 <= e2 * (s * s) <= ulp) by nra. lra.
Qed.

Lemma holds_scale c r a s x y : Rabs s <= 1 -> Rabs (x - V c) <= V r -> holds a s y ->
  holds (tm_scale c r a) s (x * y).
Proof.
  intros Hs Hx Ha. unfold holds, tm_scale; cbn.
  pose proof (mulz_err c (c0 a)) as E0. pose proof (mulz_err c (c1 a)) as E1. pose proof (mulz_err c (c2 a)) as E2.
  pose proof (rounding s _ _ _ Hs E0 E1 E2) as E.
  assert (Hr0 : 0 <= V r) by (eapply Rle_trans; [apply Rabs_pos | exact Hx]).
  assert (Hxm : Rabs x <= V (Z.abs c + r)).
  { rewrite V_add, V_abs. replace x with (V c + (x - V c)) by ring. eapply Rle_trans; [apply Rabs_triang | lra]. }
  assert (H1 : Rabs (x * (y - poly a s)) <= V (mulup (Z.abs c + r) (rem a))) by (apply mulup_abs; [exact Hxm | exact Ha]).
  assert (H2 : Rabs ((x - V c) * poly a s) <= V (if Z.eqb r 0 then 0 else mulup (magnitude a) r)).
  { destruct (Z.eqb_spec r 0) as [->|_].
    - rewrite V_0 in *. assert (x - V c = 0) as ->; [|rewrite Rmult_0_l, Rabs_R0; lra].
      apply abs_in in Hx. lra.
    - rewrite Rmult_comm. apply mulup_abs; [apply magnitude_ge; exact Hs | exact Hx]. }
  rewrite !V_add, (V_ulps 3).
  match type of E with Rabs ?u <= _ =>
    replace (x * y - poly _ s) with (x * (y - poly a s) + (x - V c) * poly a s + u)
      by (unfold poly; cbn; ring) end.
  eapply Rle_trans; [apply Rabs_triang|].
  eapply Rle_trans; [apply Rplus_le_compat_r, Rabs_triang|]. lra.
Qed.

(** *** Product of two models, as derived in verify/taylor.h: with T3 = 4 s^3 - 3 s and T4 = 8 s^4 - 8 s^2 + 1, which are in
    [-1, 1], s^3 = 3/4 s + T3/4 and s^4 = s^2 - 1/8 + T4/8. *)
Definition tm_product (a b : tm) : tm :=
  let e3 := (mulz (c1 a) (c2 b) + mulz (c2 a) (c1 b))%Z in
  let e4 := mulz (c2 a) (c2 b) in
  Tm (mulz (c0 a) (c0 b) - Z.shiftr e4 3)
     (mulz (c0 a) (c1 b) + mulz (c1 a) (c0 b) + e3 - Z.shiftr e3 2)
     (mulz (c0 a) (c2 b) + mulz (c1 a) (c1 b) + mulz (c2 a) (c0 b) + e4)
     (Z.shiftr (Z.abs e3) 2 + Z.shiftr (Z.abs e4) 3 + 2 +
      mulup (bound a) (rem b) + mulup (magnitude b) (rem a) + 12)%Z.

Definition is_const (a : tm) : bool := Z.eqb (c1 a) 0 && Z.eqb (c2 a) 0.
(** Exact 0 and 1 need no product. *)
Definition tm_scaled (c r : Z) (a : tm) : tm :=
  if Z.eqb r 0 && Z.eqb c 0 then tm_zero else if Z.eqb r 0 && Z.eqb c one then a else tm_scale c r a.
Definition tm_mul (a b : tm) : tm :=
  if is_const a then tm_scaled (c0 a) (rem a) b else if is_const b then tm_scaled (c0 b) (rem b) a else tm_product a b.

Lemma shiftr_err a k : (0 <= k)%Z -> 0 <= V a / IZR (2 ^ k) - V (Z.shiftr a k) <= ulp.
Proof. intros Hk. rewrite Z.shiftr_div_pow2 by exact Hk. apply divz_err. lia. Qed.

Lemma chebyshev3 s : Rabs s <= 1 -> Rabs (4 * (s * s * s) - 3 * s) <= 1.
Proof.
  intros H. apply abs_in in H. apply Rabs_le. split.
  - (* (s + 1) (2 s - 1)^2 >= 0 *) assert (0 <= (s + 1) * ((2 * s - 1) * (2 * s - 1))) by (apply Rmult_le_pos; [lra | apply Rle_0_sqr]). lra.
  - assert (0 <= (1 - s) * ((2 * s + 1) * (2 * s + 1))) by (apply Rmult_le_pos; [lra | apply Rle_0_sqr]). lra.
Qed.
Lemma chebyshev4 s : Rabs s <= 1 -> Rabs (8 * (s * s * (s * s)) - 8 * (s * s) + 1) <= 1.
Proof.
  intros H. apply abs_in in H. assert (0 <= s * s <= 1) by nra. apply Rabs_le. split; [|nra].
  assert (0 <= (2 * (s * s) - 1) * (2 * (s * s) - 1)) by apply Rle_0_sqr. nra.
Qed.

Lemma abs_product_le x y a b : Rabs x <= a -> Rabs y <= b -> Rabs (x * y) <= a * b.
Proof. intros. rewrite Rabs_mult. apply Rmult_le_compat; auto using Rabs_pos. Qed.

Lemma holds_product a b s x y : Rabs s <= 1 -> holds a s x -> holds b s y -> holds (tm_product a b) s (x * y).
Proof.
  intros Hs Ha Hb. unfold holds, tm_product; cbn [c0 c1 c2 rem].
  set (e3 := (mulz (c1 a) (c2 b) + mulz (c2 a) (c1 b))%Z). set (e4 := mulz (c2 a) (c2 b)).
  assert (E3 : V e3 = V (mulz (c1 a) (c2 b)) + V (mulz (c2 a) (c1 b))) by apply V_add.
  pose proof (mulz_err (c0 a) (c0 b)) as M00. pose proof (mulz_err (c0 a) (c1 b)) as M01.
  pose proof (mulz_err (c1 a) (c0 b)) as M10. pose proof (mulz_err (c0 a) (c2 b)) as M02.
  pose proof (mulz_err (c1 a) (c1 b)) as M11. pose proof (mulz_err (c2 a) (c0 b)) as M20.
  pose proof (mulz_err (c1 a) (c2 b)) as M12. pose proof (mulz_err (c2 a) (c1 b)) as M21.
  pose proof (mulz_err (c2 a) (c2 b)) as M22. fold e4 in M22.
  pose proof (shiftr_err e4 3 ltac:(lia)) as S4. pose proof (shiftr_err e3 2 ltac:(lia)) as S3.
  pose proof (shiftr_err (Z.abs e4) 3 ltac:(lia)) as A4. pose proof (shiftr_err (Z.abs e3) 2 ltac:(lia)) as A3.
  rewrite V_abs in A3, A4. change (IZR (2 ^ 3)) with 8 in *. change (IZR (2 ^ 2)) with 4 in *.
  pose proof (chebyshev3 s Hs) as T3. pose proof (chebyshev4 s Hs) as T4. pose proof ulp_pos as U.
  (* the remainders *)
  assert (R1 : Rabs (x * (y - poly b s)) <= V (mulup (bound a) (rem b)))
    by (apply mulup_abs; [apply bound_ge with s; assumption | exact Hb]).
  assert (R2 : Rabs (poly b s * (x - poly a s)) <= V (mulup (magnitude b) (rem a)))
    by (apply mulup_abs; [apply magnitude_ge; exact Hs | exact Ha]).
  (* what is left over of the powers 3 and 4 *)
  assert (L3 : Rabs (V e3 / 4 * (4 * (s * s * s) - 3 * s)) <= V (Z.shiftr (Z.abs e3) 2) + ulp).
  { eapply Rle_trans; [apply abs_times_le; exact T3|].
    unfold Rdiv. rewrite Rabs_mult, (Rabs_right (/ 4)) by lra. lra. }
  assert (L4 : Rabs (V e4 / 8 * (8 * (s * s * (s * s)) - 8 * (s * s) + 1)) <= V (Z.shiftr (Z.abs e4) 3) + ulp).
  { eapply Rle_trans; [apply abs_times_le; exact T4|].
    unfold Rdiv. rewrite Rabs_mult, (Rabs_right (/ 8)) by lra. lra. }
  rewrite !V_add, (V_ulps 2), (V_ulps 12).
  assert (Hs' := abs_in _ _ Hs). assert (Hss : 0 <= s * s <= 1) by nra.
  assert (Hs3 : Rabs (s * (s * s)) <= 1).
  { rewrite <- (Rmult_1_r 1). apply abs_product_le; [exact Hs | apply Rabs_le; lra]. }
  assert (Hs4 : Rabs (s * s * (s * s)) <= 1).
  { rewrite <- (Rmult_1_r 1). apply abs_product_le; apply Rabs_le; lra. }
  set (m00 := V (c0 a) * V (c0 b) - V (mulz (c0 a) (c0 b))) in *.
  set (m01 := V (c0 a) * V (c1 b) - V (mulz (c0 a) (c1 b))) in *.
  set (m10 := V (c1 a) * V (c0 b) - V (mulz (c1 a) (c0 b))) in *.
  set (m02 := V (c0 a) * V (c2 b) - V (mulz (c0 a) (c2 b))) in *.
  set (m11 := V (c1 a) * V (c1 b) - V (mulz (c1 a) (c1 b))) in *.
  set (m20 := V (c2 a) * V (c0 b) - V (mulz (c2 a) (c0 b))) in *.
  set (m12 := V (c1 a) * V (c2 b) - V (mulz (c1 a) (c2 b))) in *.
  set (m21 := V (c2 a) * V (c1 b) - V (mulz (c2 a) (c1 b))) in *.
  set (m22 := V (c2 a) * V (c2 b) - V e4) in *.
  set (s4 := V e4 / 8 - V (Z.shiftr e4 3)) in *.
  set (s3 := V e3 / 4 - V (Z.shiftr e3 2)) in *.
  (* twelve roundings *)
  assert (HP : Rabs (m00 + (m01 + m10) * s + (m02 + m11 + m20) * (s * s) + (m12 + m21) * (s * (s * s)) +
                     m22 * (s * s * (s * s)) - s4 - s3 * s) <= 12 * ulp).
  { assert (K : forall e k, 0 <= e <= ulp -> Rabs k <= 1 -> - ulp <= e * k <= ulp).
    { intros e k He Hk. apply abs_in in Hk. nra. }
    assert (Hs2 : Rabs (s * s) <= 1) by (apply Rabs_le; lra).
    pose proof (K m01 s M01 Hs). pose proof (K m10 s M10 Hs). pose proof (K s3 s S3 Hs).
    pose proof (K m02 (s * s) M02 Hs2). pose proof (K m11 (s * s) M11 Hs2). pose proof (K m20 (s * s) M20 Hs2).
    pose proof (K m12 _ M12 Hs3). pose proof (K m21 _ M21 Hs3). pose proof (K m22 _ M22 Hs4).
    apply Rabs_le. rewrite !Rmult_plus_distr_r. lra. }
  match type of HP with Rabs ?p <= _ => set (p0 := p) in * end.
  match type of L3 with Rabs ?p <= _ => set (l3 := p) in * end.
  match type of L4 with Rabs ?p <= _ => set (l4 := p) in * end.
  assert (X : x * y - poly (Tm (mulz (c0 a) (c0 b) - Z.shiftr e4 3)
       (mulz (c0 a) (c1 b) + mulz (c1 a) (c0 b) + e3 - Z.shiftr e3 2)
       (mulz (c0 a) (c2 b) + mulz (c1 a) (c1 b) + mulz (c2 a) (c0 b) + e4)
       (Z.shiftr (Z.abs e3) 2 + Z.shiftr (Z.abs e4) 3 + 2 +
        mulup (bound a) (rem b) + mulup (magnitude b) (rem a) + 12)%Z) s =
     x * (y - poly b s) + poly b s * (x - poly a s) + l3 + l4 + p0).
  { unfold poly, p0, l3, l4, m00, m01, m10, m02, m11, m20, m12, m21, m22, s3, s4; cbn [c0 c1 c2 rem].
    rewrite ?V_sub, ?V_add, ?V_sub, E3. field. }
  rewrite X.
  pose proof (Rabs_triang (x * (y - poly b s) + poly b s * (x - poly a s) + l3 + l4) p0).
  pose proof (Rabs_triang (x * (y - poly b s) + poly b s * (x - poly a s) + l3) l4).
  pose proof (Rabs_triang (x * (y - poly b s) + poly b s * (x - poly a s)) l3).
  pose proof (Rabs_triang (x * (y - poly b s)) (poly b s * (x - poly a s))).
  lra.
Qed.

Lemma is_const_const a : is_const a = true -> a = const (c0 a) (rem a).
Proof.
  unfold is_const. rewrite andb_true_iff, !Z.eqb_eq. destruct a; cbn. intros [-> ->]. reflexivity.
Qed.

Lemma holds_scaled c r a s x y : Rabs s <= 1 -> Rabs (x - V c) <= V r -> holds a s y ->
  holds (tm_scaled c r a) s (x * y).
Proof.
  intros Hs Hx Ha. unfold tm_scaled. destruct (Z.eqb_spec r 0) as [->|_]; cbn [andb]; [|apply holds_scale; assumption].
  destruct (Z.eqb_spec c 0) as [->|_]; [|destruct (Z.eqb_spec c one) as [->|_]; [|apply holds_scale; assumption]];
    rewrite V_0, ?V_one in Hx; apply abs_in in Hx.
  - eapply holds_eq; [|apply holds_zero]. replace x with 0 by lra. ring.
  - eapply holds_eq; [|exact Ha]. replace x with 1 by lra. ring.
Qed.

Lemma holds_mul a b s x y : Rabs s <= 1 -> holds a s x -> holds b s y -> holds (tm_mul a b) s (x * y).
Proof.
  intros Hs Ha Hb. unfold tm_mul. destruct (is_const a) eqn:Ka.
  - rewrite (is_const_const a Ka) in Ha. apply holds_const in Ha. apply holds_scaled; assumption.
  - destruct (is_const b) eqn:Kb.
    + rewrite (is_const_const b Kb) in Hb. apply holds_const in Hb. rewrite Rmult_comm. apply holds_scaled; assumption.
    + apply holds_product; assumption.
Qed.

(** *** Quotient by an integer: three roundings of the coefficients, one of the remainder. *)
Definition tm_div (a : tm) (n : Z) : tm :=
  Tm (divz (c0 a) n) (divz (c1 a) n) (divz (c2 a) n) (divz (rem a) n + 4)%Z.

Lemma holds_div a n s x : (0 < n)%Z -> Rabs s <= 1 -> holds a s x -> holds (tm_div a n) s (x / IZR n).
Proof.
  intros Hn Hs Ha. unfold holds, tm_div; cbn [c0 c1 c2 rem].
  assert (Hr : 0 < IZR n) by (apply IZR_lt; exact Hn).
  pose proof (rounding s _ _ _ Hs (divz_err (c0 a) n Hn) (divz_err (c1 a) n Hn) (divz_err (c2 a) n Hn)) as E.
  pose proof (divz_err (rem a) n Hn) as Er. rewrite V_add, (V_ulps 4).
  match type of E with Rabs ?u <= _ =>
    replace (x / IZR n - poly _ s) with ((x - poly a s) * / IZR n + u)
      by (unfold poly, Rdiv; cbn [c0 c1 c2]; ring) end.
  eapply Rle_trans; [apply Rabs_triang|]. rewrite Rabs_mult, (Rabs_right (/ IZR n)).
  - assert (Rabs (x - poly a s) * / IZR n <= V (rem a) * / IZR n).
    { apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat, Hr | exact Ha]. }
    unfold Rdiv in Er. lra.
  - left. apply Rinv_0_lt_compat, Hr.
Qed.

(** *** Bernstein coefficients: an upper bound of the quantity as a combination of three numbers with the weights
    (1-s)^2/4, (1-s)(1+s)/2, (1+s)^2/4, which are not negative and add up to 1. *)
Record upper := Upper { u0 : Z; u1 : Z; u2 : Z }.
Definition below (u : upper) (s y : R) : Prop :=
  y <= V (u0 u) * ((1 - s) * (1 - s) / 4) + V (u1 u) * ((1 - s) * (1 + s) / 2) + V (u2 u) * ((1 + s) * (1 + s) / 4).

Definition upper_of (a : tm) : upper :=
  Upper (c0 a - c1 a + c2 a + rem a) (c0 a - c2 a + rem a) (c0 a + c1 a + c2 a + rem a).
Definition upper_max (a b : upper) : upper :=
  Upper (Z.max (u0 a) (u0 b)) (Z.max (u1 a) (u1 b)) (Z.max (u2 a) (u2 b)).
Definition upper_add (a b : upper) : upper := Upper (u0 a + u0 b) (u1 a + u1 b) (u2 a + u2 b).
Definition upper_const (c : Z) : upper := Upper c c c.
Definition negative (a : upper) : bool := Z.ltb (u0 a) 0 && Z.ltb (u1 a) 0 && Z.ltb (u2 a) 0.

Lemma below_of a s x : holds a s x -> below (upper_of a) s x.
Proof.
  unfold holds, below, upper_of, poly; cbn. rewrite !V_add, !V_sub. intros H. apply abs_in in H.
  match goal with |- _ <= ?r => replace r with (V (c0 a) + V (c1 a) * s + V (c2 a) * (s * s) + V (rem a)) by field end.
  lra.
Qed.

Lemma weights s : Rabs s <= 1 ->
  0 <= (1 - s) * (1 - s) / 4 /\ 0 <= (1 - s) * (1 + s) / 2 /\ 0 <= (1 + s) * (1 + s) / 4.
Proof.
  intros H. apply abs_in in H. repeat split; unfold Rdiv; apply Rmult_le_pos; try lra; apply Rmult_le_pos; lra.
Qed.

Definition upper_le (a b : upper) := (u0 a <= u0 b)%Z /\ (u1 a <= u1 b)%Z /\ (u2 a <= u2 b)%Z.
Lemma below_mono a b s x : Rabs s <= 1 -> upper_le a b -> below a s x -> below b s x.
Proof.
  intros Hs (L0 & L1 & L2) H. destruct (weights s Hs) as (W0 & W1 & W2). unfold below in *.
  apply V_le in L0, L1, L2.
  eapply Rle_trans; [exact H|]. repeat apply Rplus_le_compat; apply Rmult_le_compat_r; assumption.
Qed.
Lemma upper_max_l a b : upper_le a (upper_max a b).
Proof. unfold upper_le, upper_max; cbn. lia. Qed.
Lemma upper_max_r a b : upper_le b (upper_max a b).
Proof. unfold upper_le, upper_max; cbn. lia. Qed.

Lemma below_add a b s x y : below a s x -> below b s y -> below (upper_add a b) s (x + y).
Proof. unfold below, upper_add; cbn. rewrite !V_add. intros. lra. Qed.
Lemma below_const c s x : x <= V c -> below (upper_const c) s x.
Proof. unfold below, upper_const; cbn. intros. match goal with |- _ <= ?r => replace r with (V c) by field end. lra. Qed.

Lemma below_negative a s x : Rabs s <= 1 -> negative a = true -> below a s x -> x < 0.
Proof.
  intros Hs N H. unfold negative in N. rewrite !andb_true_iff, !Z.ltb_lt in N. destruct N as [[N0 N1] N2].
  apply V_lt in N0, N1, N2. rewrite V_0 in *. destruct (weights s Hs) as (W0 & W1 & W2). unfold below in H.
  assert (W : (1 - s) * (1 - s) / 4 + (1 - s) * (1 + s) / 2 + (1 + s) * (1 + s) / 4 = 1) by field.
  set (w0 := (1 - s) * (1 - s) / 4) in *. set (w1 := (1 - s) * (1 + s) / 2) in *.
  set (w2 := (1 + s) * (1 + s) / 4) in *.
  assert (V (u0 a) * w0 <= 0) by nra. assert (V (u1 a) * w1 <= 0) by nra. assert (V (u2 a) * w2 <= 0) by nra.
  destruct (Req_dec w0 0) as [Z0|Z0]; [|nra]. destruct (Req_dec w1 0) as [Z1|Z1]; [|nra].
  assert (w2 = 1) by lra. nra.
Qed.
